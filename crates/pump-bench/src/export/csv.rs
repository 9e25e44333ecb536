//! Step lists and waveforms as CSV.

use std::io::{self, Write};

use pump_ctl::plan::{FlowMotion, Plan};

use crate::simulation::Sample;

/// Header of the table that [`write_steps`] writes.
const STEPS_HEADER: &str = "step,time_s,direction,angle_rad";
/// Header of the table that [`write_samples`] writes.
pub(crate) const TRACE_HEADER: &str =
    "time_s,angle_rad,speed_rad_s,q_in_ml_s,q_out_ml_s,p_in_kpa,p_out_kpa,delivered_ml";

/// Writes every step of `plan`, then every step of the retraction after it, with numbers in full precision.
///
/// The numbers of the steps go on over the retraction. It starts `rest_s` after the last step of the dose.
///
/// # Errors
/// Returns the [`io::Error`] of the writer.
pub fn write_steps(to: &mut dyn Write, plan: &Plan, retraction: Option<(f64, &Plan)>) -> io::Result<()> {
    writeln!(to, "{STEPS_HEADER}")?;
    let (made, end_s) = (plan.steps().unsigned_abs(), plan.profile().duration_s());
    let back = retraction.into_iter().map(|(rest_s, back)| (made, end_s + rest_s, back));
    for (before, start_s, plan) in [(0, 0.0, plan)].into_iter().chain(back) {
        for step in plan.each_step() {
            let (number, time_s) = (before + step.number, start_s + step.time_s);
            writeln!(to, "{number},{time_s},{},{}", step.direction.sign(), step.angle_rad)?;
        }
    }
    Ok(())
}

/// Writes every step of a flow over time, with numbers in full precision.
///
/// # Errors
/// Returns the [`io::Error`] of the writer.
pub fn write_flow_steps(to: &mut dyn Write, flow: &FlowMotion<'_>) -> io::Result<()> {
    writeln!(to, "{STEPS_HEADER}")?;
    for step in flow.each_step() {
        writeln!(to, "{},{},{},{}", step.number, step.time_s, step.direction.sign(), step.angle_rad)?;
    }
    Ok(())
}

/// Writes every sample of a waveform, with numbers in full precision.
///
/// # Errors
/// Returns the [`io::Error`] of the writer, or the first error of the waveform.
pub fn write_samples<E: Into<io::Error>>(
    to: &mut dyn Write,
    samples: impl IntoIterator<Item = Result<Sample, E>>,
) -> io::Result<()> {
    writeln!(to, "{TRACE_HEADER}")?;
    for sample in samples {
        let s = sample.map_err(Into::into)?;
        writeln!(
            to,
            "{},{},{},{},{},{},{},{}",
            s.time_s,
            s.angle_rad,
            s.speed_rad_s,
            s.q_in_ml_s,
            s.q_out_ml_s,
            s.p_in_kpa,
            s.p_out_kpa,
            s.delivered_ml
        )?;
    }
    Ok(())
}
