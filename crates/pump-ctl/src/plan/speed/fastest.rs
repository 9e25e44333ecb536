//! The fastest dose that holds every limit.

use pump_model::Pump;

use crate::plan::Plan;
use crate::plan::limits::{Bound, Limits, Margin};
use crate::plan::line_states::LineStates;
use crate::plan::words::{LimitedBy, PlanError};

/// The speed, rad/s, and the plan that is fastest among speeds that are connected to rest. The error is the limit
/// that even the slowest speed breaks, with its margin.
pub(super) type Fastest = Result<(f64, Plan), (Bound, Margin)>;

/// Slowest speed that is tried, as a part of the fastest speed.
const SLOWEST: f64 = 1.0 / 4096.0;

/// Finds the fastest cruise up to `top_rad_s` that holds every limit, and below which every slower cruise
/// holds them.
///
/// The whole dose is predicted at each speed, start-up, stop and settling included. The speeds that hold are
/// not an interval, since pressures fall again past a resonance. So the search tries speeds upwards, from a
/// speed so slow that no motion could break a limit. Lines that are undamped or not at rest give no such
/// bound. The first speed is then 1/4096 of the fastest. Each step is a sixteenth of the lines' damping
/// ratio, 0.1 to 1 %. The first speed that breaks a limit ends the search, and bisection refines the last
/// speed that holds to 1e-6.
///
/// A resonance is 2 damping ratios wide, which is 32 steps. Pressures change in it by some tenths of a per
/// cent from step to step. The search may pass over a window of speeds narrower than a step, in which a limit
/// is broken by about that much. The returned plan holds its limits in any case.
pub(super) fn fastest(
    pump: &Pump,
    limits: &Limits,
    top_rad_s: f64,
    at_speed: &impl Fn(f64) -> Plan,
) -> Result<Fastest, PlanError> {
    let topmost = at_speed(top_rad_s);
    let unbound = if topmost.profile.reaches_limit() { LimitedBy::Speed } else { LimitedBy::Acceleration };
    if !limits.are_predicted() {
        return Ok(Ok((top_rad_s, Plan { limited_by: unbound, ..topmost })));
    }
    let damping = pump.inlet().damping_ratio().min(pump.outlet().damping_ratio());
    let ratio = 1.0 + (damping / 16.0).clamp(0.001, 0.01);
    // A dose too short to cruise does not change at speeds above its peak.
    let top_rad_s = if topmost.profile.reaches_limit() || topmost.is_smooth() {
        top_rad_s
    } else {
        topmost.profile.peak_rad_s()
    };

    let is_safe = |rad_s: f64| cannot_break(pump, limits, &at_speed(rad_s));
    let (mut slowest, mut too_fast) = (top_rad_s, top_rad_s);
    while slowest > SLOWEST * top_rad_s && !is_safe(slowest) {
        (slowest, too_fast) = (0.5 * slowest, slowest);
    }
    // A try by this bound costs a hundredth of a prediction, and leaves out a seventieth of an octave and more.
    while too_fast > ratio * slowest {
        let middle = 0.5 * (slowest + too_fast);
        if is_safe(middle) { slowest = middle } else { too_fast = middle }
    }
    let (mut good, mut holds) = (slowest, at_speed(slowest));
    if let Some(broken) = limits.broken(pump, &holds) {
        return Ok(Err(broken));
    }
    let (mut bad, (mut bound, _)) = loop {
        if good >= top_rad_s {
            return Ok(Ok((good, Plan { limited_by: unbound, ..holds })));
        }
        let next = (good * ratio).min(top_rad_s);
        let plan = at_speed(next);
        if let Some(broken) = limits.broken(pump, &plan) {
            break (next, broken);
        }
        (good, holds) = (next, plan);
    };
    while bad - good > 1e-6 * bad {
        let middle = 0.5 * (good + bad);
        let plan = at_speed(middle);
        match limits.broken(pump, &plan) {
            Some(by) => (bad, (bound, _)) = (middle, by),
            None => (good, holds) = (middle, plan),
        }
    }
    Ok(Ok((good, Plan { limited_by: bound.limited_by(holds.direction()), ..holds })))
}

/// Returns true if no motion up to the fastest speed of `plan`, from lines at rest, could break a limit.
fn cannot_break(pump: &Pump, limits: &Limits, plan: &Plan) -> bool {
    if plan.lines != LineStates::AT_REST {
        return false;
    }
    let peak_rad_s = plan.profile.peak_rad_s();
    let [inlet, outlet] = [pump.inlet_curve(), pump.outlet_curve()].map(|curve| curve.largest_flow_ml_rad());
    let within_kpa = [
        inlet * peak_rad_s * pump.inlet().worst_kpa_s_ml(),
        outlet * peak_rad_s * pump.outlet().worst_kpa_s_ml(),
    ];
    let most_kpa = within_kpa[0].max(within_kpa[1]);
    let [sucking, pushing] = Limits::ports(plan.direction());
    let room = |limit: Option<f64>, port, sign: f64| {
        let room_kpa = limit.map_or(f64::INFINITY, |kpa| sign * (kpa - pump.line(port).reservoir_kpa));
        room_kpa - plan.step_kpa(pump, port)
    };
    let lowest_kpa = limits.lowest_where_it_sucks().map(|lowest| lowest.kpa);
    let pressures = most_kpa < room(limits.pressures.max_outlet_kpa, pushing, 1.0)
        && most_kpa < room(lowest_kpa, sucking, -1.0)
        && most_kpa < room(limits.lowest.map(|lowest| lowest.kpa), pushing, -1.0);
    pressures
        && limits.torque.is_none_or(|torque| {
            let acceleration_rad_s2 = plan.profile.acceleration_rad_s2();
            torque.bound_n_m(pump, within_kpa, inlet.max(outlet), acceleration_rad_s2)
                < torque.motor.least_to(peak_rad_s)
        })
}
