//! The slowest cruise that meets a time.

use libm::{floor, log, pow};
use pump_model::Pump;

use super::fastest::fastest;
use super::refusal::refusal;
use super::rounded::up;
use crate::plan::Plan;
use crate::plan::limits::Limits;
use crate::plan::words::{Nearest, PlanError};

/// Makes the refusal of a time that no speed meets. If limits are predicted, it names a time that holds them
/// too.
pub(super) fn shortest_within_limits(
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
        Ok(Ok((_, plan))) => match total_s(pump, &plan) {
            Ok(total_s) => PlanError::TimeTooShort { asked_s, fastest_s: fastest_s.max(up(total_s)) },
            Err(error) => error,
        },
        Ok(Err((bound, margin))) => {
            let direction = at_speed(limits.motor.max_speed_rad_s).direction();
            refusal(limits, direction, bound, margin, Nearest::Nothing)
        }
        Err(error) => error,
    }
}

/// Returns the time of motion and settling, s.
pub(super) fn total_s(pump: &Pump, plan: &Plan) -> Result<f64, PlanError> {
    Ok(plan.profile.duration_s() + plan.settle_s(pump)?)
}

/// Finds the slowest cruise whose motion and settling take `time_s` at most.
///
/// Settling depends on where in its swing the line is when the motor stops. So the total time does not fall
/// evenly with the speed. The search goes upwards in steps of 1 % from the slowest speed whose motion alone
/// meets the time. Bisection refines the first speed that meets the time. The search may pass over a window
/// narrower than 1 %.
pub(super) fn slowest_within(
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
    // Counted from the fastest, the speeds do not depend on the time. So the shortest time that a refusal names is met.
    let mut left = floor(log(fastest_rad_s / slow) / log(RATIO)).max(0.0);
    let mut shortest_s = f64::INFINITY;
    let mut fast = loop {
        let fast = fastest_rad_s * pow(RATIO, -left);
        let total_s = total_s(fast)?;
        shortest_s = shortest_s.min(total_s);
        if total_s <= time_s {
            break fast;
        }
        if left <= 0.0 {
            return Err(PlanError::TimeTooShort { asked_s: time_s, fastest_s: up(shortest_s) });
        }
        slow = fast;
        left -= 1.0;
    };
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

/// Finds the slowest speed up to `limit_rad_s` whose motion alone takes `time_s` at most.
///
/// If no speed meets the time, the result is a tenth of the limit. The search upwards from there finds the
/// shortest possible time.
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
