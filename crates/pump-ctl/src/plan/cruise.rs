//! Which cruise speed a request means.

use pump_model::Pump;
use pump_model::math::{TURN_RAD, ceil, floor, log10, pow, rad_s, rpm};

use super::fastest::{Fastest, fastest};
use super::margins::Margin;
use super::{Cruise, LimitedBy, Limits, Lowest, Nearest, Plan, PlanError, SetBy};

/// Longest dose, s: 58 days, over which f64 resolves a step's time to a nanosecond.
const MAX_DURATION_S: f64 = 5e6;

/// Speed, rad/s, whose mean flow over whole pitches is `flow_ml_s`: the inverse of
/// [`Pump::average_flow_ml_s`].
///
/// ```
/// let pump = pump_model::Pump::three_roller();
/// let speed = pump_ctl::plan::speed_for_flow(&pump, 5.0);
/// assert!((pump.average_flow_ml_s(speed) - 5.0).abs() < 1e-12);
/// ```
pub fn speed_for_flow(pump: &Pump, flow_ml_s: f64) -> f64 {
    flow_ml_s * TURN_RAD / pump.revolution_ml()
}

/// Digits of what a message says can be had or is needed.
const DIGITS: f64 = 5.0;

/// The power of ten that makes [`DIGITS`] digits of a positive number whole.
fn scale(x: f64) -> f64 {
    pow(10.0, DIGITS - 1.0 - floor(log10(x)))
}

/// `x` rounded up, so that what a message says is needed is enough.
fn up(x: f64) -> f64 {
    ceil(x * scale(x)) / scale(x)
}

/// `x` rounded down, so that what a message says can be had can be had.
fn down(x: f64) -> f64 {
    floor(x * scale(x)) / scale(x)
}

/// Plan at the speed that `cruise` means, within every limit.
pub(super) fn choose(
    pump: &Pump,
    cruise: Cruise,
    limits: &Limits,
    at_speed: impl Fn(f64) -> Plan,
) -> Result<Plan, PlanError> {
    let limit_rad_s = limits.motor.max_speed_rad_s;
    // A limit written in r/min may round to a hair less than the same speed asked for.
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
            let Fastest { plan, limited_by, beyond } = fastest(pump, limits, limit_rad_s, &at_speed)?;
            let Some((_, plan)) = plan else {
                return Err(refusal(limits, limited_by, beyond, Nearest::Nothing));
            };
            return short_enough(plan);
        }
    };
    let plan = short_enough(plan)?;
    let Some((limited_by, margin)) = limits.margins(pump, &plan).broken() else {
        return Ok(plan);
    };
    let nearest = match fastest(pump, limits, top_rad_s, &at_speed)?.plan {
        None => Nearest::Nothing,
        Some((rad_s, plan)) => offer(pump, limits, cruise, rad_s, &plan, &at_speed)?,
    };
    Err(refusal(limits, limited_by, Some(margin), nearest))
}

/// What can be had in place of a dose that is refused, in the terms of what was asked: `fastest`, rounded to where whoever asks for
/// just that gets it. Rounding changes the speed, which may break a limit again by a hair; then the next number is tried.
fn offer(
    pump: &Pump,
    limits: &Limits,
    cruise: Cruise,
    fastest_rad_s: f64,
    fastest: &Plan,
    at_speed: &impl Fn(f64) -> Plan,
) -> Result<Nearest, PlanError> {
    const TRIES: u32 = 20;
    let holds = |plan: &Plan| limits.broken(pump, plan).is_none();
    let next = |x: f64| 1.0 / scale(x);
    match cruise {
        Cruise::Within { .. } => {
            let mut time_s = up(total_s(pump, fastest)?);
            for _ in 0..TRIES {
                let plan = slowest_within(pump, time_s, fastest_rad_s, at_speed);
                if plan.is_ok_and(|plan| holds(&plan)) {
                    return Ok(Nearest::Within { time_s });
                }
                time_s = up(time_s + 0.5 * next(time_s));
            }
        }
        Cruise::Flow { .. } => {
            let mut ml_s = down(pump.average_flow_ml_s(fastest_rad_s));
            for _ in 0..TRIES {
                if holds(&at_speed(speed_for_flow(pump, ml_s))) {
                    return Ok(Nearest::Flow { ml_s });
                }
                ml_s = down(ml_s - 0.5 * next(ml_s));
            }
        }
        Cruise::Speed { .. } | Cruise::Fastest => {
            let mut speed_rpm = down(rpm(fastest_rad_s));
            for _ in 0..TRIES {
                if holds(&at_speed(rad_s(speed_rpm))) {
                    return Ok(Nearest::Speed { rpm: speed_rpm });
                }
                speed_rpm = down(speed_rpm - 0.5 * next(speed_rpm));
            }
        }
    }
    Ok(Nearest::Nothing)
}

fn short_enough(plan: Plan) -> Result<Plan, PlanError> {
    let duration_s = plan.profile.duration_s();
    if duration_s <= MAX_DURATION_S { Ok(plan) } else { Err(PlanError::TooSlow { duration_s }) }
}

/// Why a plan that breaks a limit is refused.
fn refusal(limits: &Limits, limited_by: LimitedBy, margin: Option<Margin>, nearest: Nearest) -> PlanError {
    let (reached, limit) = margin.map_or((f64::NAN, f64::NAN), |margin| (margin.reached, margin.limit));
    let set_by = |lowest: Option<Lowest>| lowest.map_or(SetBy::Given, |lowest| lowest.set_by);
    match limited_by {
        LimitedBy::OutletPressure => {
            PlanError::OutletPressure { predicted_kpa: reached, limit_kpa: limit, nearest }
        }
        LimitedBy::InletPressure => {
            let set_by = set_by(limits.lowest_where_it_sucks());
            PlanError::InletPressure { predicted_kpa: reached, limit_kpa: limit, set_by, nearest }
        }
        LimitedBy::OutletSuction => {
            let set_by = set_by(limits.lowest);
            PlanError::OutletSuction { predicted_kpa: reached, limit_kpa: limit, set_by, nearest }
        }
        _ => PlanError::Torque { needed_n_m: reached, limit_n_m: limit, nearest },
    }
}

/// The refusal of a time that no speed meets, where limits are predicted with a time that holds them.
fn shortest_within_limits(
    pump: &Pump,
    limits: &Limits,
    error: PlanError,
    at_speed: &impl Fn(f64) -> Plan,
) -> PlanError {
    let PlanError::TimeTooShort { asked_s, fastest_s } = error else {
        return error;
    };
    if !limits.are_predicted() {
        return error;
    }
    match fastest(pump, limits, limits.motor.max_speed_rad_s, at_speed) {
        Ok(Fastest { plan: Some((_, plan)), .. }) => match total_s(pump, &plan) {
            Ok(total_s) => PlanError::TimeTooShort { asked_s, fastest_s: fastest_s.max(up(total_s)) },
            Err(error) => error,
        },
        Ok(Fastest { plan: None, limited_by, beyond }) => {
            refusal(limits, limited_by, beyond, Nearest::Nothing)
        }
        Err(error) => error,
    }
}

/// Time of motion and settling, s.
fn total_s(pump: &Pump, plan: &Plan) -> Result<f64, PlanError> {
    Ok(plan.profile.duration_s() + plan.settle_s(pump)?)
}

/// The slowest cruise whose motion and settling take `time_s` at most.
///
/// Settling depends on where in its swing the line is when the motor stops, so the total time does not fall evenly
/// with the speed: the speeds are searched upwards in steps of 1 % from the slowest whose motion alone would do, and
/// the first that meets the time is refined by bisection. A window narrower than 1 % may be passed over.
fn slowest_within(
    pump: &Pump,
    time_s: f64,
    limit_rad_s: f64,
    at_speed: &impl Fn(f64) -> Plan,
) -> Result<Plan, PlanError> {
    const RATIO: f64 = 1.01;
    let total_s = |speed_rad_s| total_s(pump, &at_speed(speed_rad_s));

    let fastest_rad_s = at_speed(limit_rad_s).profile.peak_rad_s().min(limit_rad_s);
    let mut slow = slowest_motion_within(time_s, fastest_rad_s, at_speed);
    if total_s(slow)? <= time_s {
        return Ok(at_speed(slow));
    }
    let mut fast = slow;
    let mut shortest_s = f64::INFINITY;
    loop {
        if fast >= fastest_rad_s {
            return Err(PlanError::TimeTooShort { asked_s: time_s, fastest_s: up(shortest_s) });
        }
        fast = (fast * RATIO).min(fastest_rad_s);
        let total_s = total_s(fast)?;
        shortest_s = shortest_s.min(total_s);
        if total_s <= time_s {
            break;
        }
        slow = fast;
    }
    while fast - slow > 1e-9 * fast {
        let middle = 0.5 * (slow + fast);
        if total_s(middle)? <= time_s {
            fast = middle;
        } else {
            slow = middle;
        }
    }
    Ok(at_speed(fast))
}

/// The slowest speed up to `limit_rad_s` whose motion alone takes `time_s` at most; where none does, a tenth of the
/// limit, from which the search upwards finds the shortest time there is.
fn slowest_motion_within(time_s: f64, limit_rad_s: f64, at_speed: impl Fn(f64) -> Plan) -> f64 {
    if at_speed(limit_rad_s).profile.duration_s() > time_s {
        return 0.1 * limit_rad_s;
    }
    let (mut slow, mut fast) = (0.0, limit_rad_s);
    while fast - slow > 1e-12 * fast {
        let middle = 0.5 * (slow + fast);
        if at_speed(middle).profile.duration_s() <= time_s {
            fast = middle;
        } else {
            slow = middle;
        }
    }
    fast
}
