//! The ripple of the flow, recomputed from the recorded edges.

use std::error::Error;

use pump_ctl::plan::Plan;
use pump_model::Pump;

use crate::check;

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
    let volumes: Vec<f64> = (0..=rises_ns.len()).map(|n| plan.delivered_ml(pump, n as u64)).collect();
    let ripple = |times_ns: &[f64]| {
        let flow = |n: usize| {
            let end = n + WINDOW;
            let volume = volumes.get(end + 1)? - volumes.get(n + 1)?;
            Some(1e9 * volume.abs() / (times_ns.get(end)? - times_ns.get(n)?))
        };
        let flows: Vec<f64> = (from..from + pitch).step_by(WINDOW).filter_map(flow).collect();
        let mean = flows.iter().sum::<f64>() / flows.len() as f64;
        (flows.iter().map(|flow| (flow / mean - 1.0).powi(2)).sum::<f64>() / flows.len() as f64).sqrt()
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
    check((recorded - expected).abs() <= MOST_DIFFERENCE, "the ripple from the edges")
}
