//! The dose that is possible in place of a refused one.

use pump_model::Pump;
use pump_model::units::{rad_s, rpm};

use super::for_flow::speed_for_flow;
use super::rounded::{down, scale, up};
use super::within::{slowest_within, total_s};
use crate::plan::Plan;
use crate::plan::limits::Limits;
use crate::plan::words::{Cruise, Nearest, PlanError};

/// Finds the nearest dose that holds every limit, in the terms of `cruise`.
///
/// The dose is `fastest`, rounded so that a request for the rounded number is accepted. Rounding changes the
/// speed, which may break a limit again by a hair. The search then tries the next number.
pub(super) fn nearest(
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
