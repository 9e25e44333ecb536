//! The calibration that was in use before, where it was surer than the one in its place.

use pump_ctl::plan::speed_for_flow;
use pump_model::units::rpm;

use crate::bench::Bench;
use crate::calibration::{Calibration, CalibrationError, Stored};
use crate::numbers::two_digits;

/// Uncertainty over that of the calibration before from which on it is told.
const LESS_SURE: f64 = 1.1;

/// Returns the warning of a calibration that shows the mean volume less well than `before`, which it replaces. Runs
/// that are joined to those of `before` show the scatter better, though it may be larger. A calibration of another
/// tube, fluid or drive is no choice.
pub(super) fn surer_before(
    bench: &Bench,
    stored: &Stored,
    before: Option<&Stored>,
) -> Result<Option<String>, CalibrationError> {
    let now = &stored.calibration;
    let Some(before) = before.filter(|before| is_choice(&before.calibration, now)) else { return Ok(None) };
    let (file, base) = (bench.file(), bench.model());
    let speed_rpm = rpm(speed_for_flow(base, file.pump.default_rate_ml_s));
    let part = |calibration: &Calibration| {
        let sureness = calibration.sureness_at(base, speed_rpm, file)?;
        Ok::<_, CalibrationError>(sureness.map(|sureness| sureness.common()))
    };
    let (Some(now), Some(then)) = (part(now)?, part(&before.calibration)?) else { return Ok(None) };
    Ok((now > LESS_SURE * then).then(|| {
        format!(
            "the mean volume at the default rate is known to {} % (k = 2), and calibration {} knew it to {} %; it \
             stays on record",
            two_digits(200.0 * now),
            before.version,
            two_digits(200.0 * then)
        )
    }))
}

/// Returns true if `before` holds for the pump of `now` too, by runs of its own.
fn is_choice(before: &Calibration, now: &Calibration) -> bool {
    let of_pump = |one: &Calibration| (one.revolution_ml, one.steps_per_rev, one.fluid.to_lowercase());
    let is_of_tube = before.tube_number == now.tube_number || now.tube_number.is_none();
    is_of_tube && of_pump(before) == of_pump(now) && !before.runs.iter().any(|run| now.runs.contains(run))
}
