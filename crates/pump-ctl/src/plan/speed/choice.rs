//! The plan at the cruise speed that a request asks for.

use pump_model::Pump;
use pump_model::units::rpm;

use super::fastest::fastest;
use super::for_flow::speed_for_flow;
use super::nearest::nearest;
use super::refusal::refusal;
use super::rounded::{down, up};
use super::within::{shortest_within_limits, slowest_within};
use crate::plan::Plan;
use crate::plan::limits::Limits;
use crate::plan::words::{Cruise, Nearest, PlanError};

/// Longest dose, s. It is 58 days, over which f64 resolves a step's time to a nanosecond.
pub const MAX_DURATION_S: f64 = 5e6;

/// Plans at the speed that `cruise` asks for, within every limit.
pub(in crate::plan) fn choose(
    pump: &Pump,
    cruise: Cruise,
    limits: &Limits,
    at_speed: impl Fn(f64) -> Plan,
) -> Result<Plan, PlanError> {
    let limit_rad_s = limits.motor.max_speed_rad_s;
    // A limit written in r/min may round to a hair less than an equal speed asked for.
    let allowed = |speed_rad_s: f64| speed_rad_s <= limit_rad_s * (1.0 + 1e-12);
    let (plan, top_rad_s) = match cruise {
        Cruise::Flow { ml_s } => {
            let speed_rad_s = speed_for_flow(pump, ml_s);
            if !allowed(speed_rad_s) {
                return Err(PlanError::RateTooHigh {
                    flow_ml_s: ml_s,
                    needed_rpm: up(rpm(speed_rad_s)),
                    limit_rpm: rpm(limit_rad_s),
                    limit_ml_s: down(pump.average_flow_ml_s(limit_rad_s)),
                });
            }
            (at_speed(speed_rad_s), speed_rad_s)
        }
        Cruise::Speed { rad_s } => {
            if !allowed(rad_s) {
                return Err(PlanError::SpeedTooHigh { speed_rpm: rpm(rad_s), limit_rpm: rpm(limit_rad_s) });
            }
            (at_speed(rad_s), rad_s)
        }
        Cruise::Within { time_s } => {
            let found = slowest_within(pump, time_s, limit_rad_s, &at_speed);
            (found.map_err(|error| shortest_within_limits(pump, limits, error, &at_speed))?, limit_rad_s)
        }
        Cruise::Fastest => {
            return match fastest(pump, limits, limit_rad_s, &at_speed)? {
                Ok((_, plan)) => {
                    short_enough(&plan)?;
                    Ok(plan)
                }
                Err((bound, margin)) => {
                    let direction = at_speed(limit_rad_s).direction();
                    Err(refusal(limits, direction, bound, margin, Nearest::Nothing))
                }
            };
        }
    };
    short_enough(&plan)?;
    let Some((bound, margin)) = limits.margins(pump, &plan).broken() else {
        return Ok(plan);
    };
    let instead = match fastest(pump, limits, top_rad_s, &at_speed)? {
        Err(_) => Nearest::Nothing,
        Ok((rad_s, plan)) => nearest(pump, limits, cruise, rad_s, &plan, &at_speed)?,
    };
    Err(refusal(limits, plan.direction(), bound, margin, instead))
}

/// Refuses a plan that takes longer than any controller keeps time.
fn short_enough(plan: &Plan) -> Result<(), PlanError> {
    let duration_s = plan.profile.duration_s();
    if duration_s <= MAX_DURATION_S { Ok(()) } else { Err(PlanError::TooSlow { duration_s }) }
}
