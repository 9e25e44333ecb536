//! The pump file's default rate beside the speeds of weighed runs.

use pump_model::Pump;
use pump_model::units::rpm;

use super::{AgainstSpeed, CalibrationError, Displacement};
use crate::displacement::SpeedDependentPump;
use crate::numbers::{short, significant};
use crate::pump_file::PumpFile;

/// Returns the warning of runs to be weighed at these speeds, in r/min, that leave out the pump file's default
/// rate. The model gives the speed of that rate. `None` if they cover it, or if there is one speed, which is
/// used at every speed.
///
/// ```
/// use pump_bench::calibration::default_rate_left_out;
/// let file = pump_bench::built_in("three-roller").unwrap();
/// let pump = file.model()?;
/// assert_eq!(default_rate_left_out(&file, &pump, &[10.0, 60.0]), None);
/// let warning = default_rate_left_out(&file, &pump, &[20.0, 60.0]).unwrap();
/// assert!(warning.starts_with("the default rate of 5 mL/s takes 14.072 r/min"));
/// # Ok::<(), pump_model::ModelError>(())
/// ```
pub fn default_rate_left_out(file: &PumpFile, base: &Pump, speeds_rpm: &[f64]) -> Option<String> {
    let least_rpm = speeds_rpm.iter().copied().reduce(f64::min)?;
    let most_rpm = speeds_rpm.iter().copied().reduce(f64::max)?;
    let rate_ml_s = file.pump.default_rate_ml_s;
    let speed_rpm = rpm(pump_ctl::plan::speed_for_flow(base, rate_ml_s));
    let is_left_out = least_rpm < most_rpm && !(least_rpm..=most_rpm).contains(&speed_rpm);
    is_left_out.then(|| warning(rate_ml_s, Some(speed_rpm), (least_rpm, most_rpm)))
}

/// Returns the warning of a calibration that leaves out the default rate of the pump of `file`, which is `base`
/// without calibration.
///
/// # Errors
///
/// [`CalibrationError::Model`] where a fitted law cannot be computed for this pump.
pub(crate) fn default_rate_uncovered(
    file: &PumpFile,
    base: &Pump,
    found: &Displacement,
) -> Result<Option<String>, CalibrationError> {
    let pump = SpeedDependentPump::constant(*base);
    let Some(against) = AgainstSpeed::of(Some(found), &pump) else { return Ok(None) };
    let Some(range_rpm) = against.range_rpm() else { return Ok(None) };
    let rate_ml_s = file.pump.default_rate_ml_s;
    let speed_rpm = against.speed_for_flow(rate_ml_s, false)?;
    let is_covered = speed_rpm.is_some_and(|speed_rpm| against.covers(speed_rpm));
    Ok((!is_covered).then(|| warning(rate_ml_s, speed_rpm, range_rpm)))
}

/// Returns the words for a default rate that runs leave out. No speed may give that rate.
fn warning(rate_ml_s: f64, speed_rpm: Option<f64>, (least_rpm, most_rpm): (f64, f64)) -> String {
    let takes = speed_rpm.map_or("is beyond what the runs show".to_owned(), |speed_rpm| {
        format!("takes {} r/min", significant(speed_rpm, 5))
    });
    format!(
        "the default rate of {} mL/s {takes}, and the runs cover {} to {} r/min: doses that \
         name no other rate will be refused; make runs on both sides of that rate, or change default_rate_ml_s in the \
         pump file",
        significant(rate_ml_s, 4),
        short(least_rpm),
        short(most_rpm)
    )
}
