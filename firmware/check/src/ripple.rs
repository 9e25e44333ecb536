//! The ripple of the flow, recomputed from the recorded edges.

use std::error::Error;

use pump_ctl::plan::Plan;
use pump_model::Pump;

use crate::check;
use crate::doses::START_RAD;

/// Steps over which the flow is taken. A tick of the board is then less than 0.1 % of the time.
const WINDOW: usize = 8;

/// Largest difference of the ripples of the recorded and of the planned steps, as a part of the mean flow.
const MOST_DIFFERENCE: f64 = 1e-3;

/// Holds the ripple at the outlet's rollers over a pitch of the cruise, from the recorded edges, against that of the
/// plan.
pub(crate) fn hold(pump: &Pump, plan: &Plan, rises_ns: &[f64]) -> Result<(), Box<dyn Error>> {
    let pitch = (pump.pitch_rad() / plan.step_rad()).round() as usize;
    let from = rises_ns.len().checked_sub(pitch + WINDOW).ok_or("the dose has no whole pitch")? / 2;
    let planned: Vec<f64> = plan.each_step().map(|step| 1e9 * step.time_s).collect();
    let volume = |n: usize| pump.outlet_curve().volume_ml(START_RAD + n as f64 * plan.step_rad());
    let ripple = |times_ns: &[f64]| {
        // Volume and time of each window: the ripple is over time.
        let window = |n: usize| {
            let end = n + WINDOW;
            Some((volume(end) - volume(n), times_ns.get(end)? - times_ns.get(n)?))
        };
        let windows: Vec<_> = (from..from + pitch).step_by(WINDOW).filter_map(window).collect();
        let (ml, ns) = windows.iter().fold((0.0, 0.0), |(ml, ns), one| (ml + one.0, ns + one.1));
        let square = |(v, t): &(f64, f64)| t * (v / t * ns / ml - 1.0).powi(2);
        (windows.iter().map(square).sum::<f64>() / ns).sqrt()
    };
    let (recorded, expected) = (ripple(rises_ns), ripple(&planned));
    let ripples = plan.ripples(pump);
    println!(
        "  ripple over a pitch: {:.3} % from the edges, {:.3} % from the plan's times, {:.3} % stated; {:.1} % at \
         constant speed",
        100.0 * recorded,
        100.0 * expected,
        100.0 * ripples.after.rms,
        100.0 * ripples.before.rms
    );
    let off = (recorded - expected).abs().max((recorded - ripples.after.rms).abs());
    check(off <= MOST_DIFFERENCE, "the ripple from the edges")
}
