//! Errors of a pump's pulse: roller volume, engagement angle and zero.

use pump_model::units::degrees;
use pump_model::{ModelError, Pump};

use super::errors::Draw;
use crate::calibration::{Applied, PulseSureness};
use crate::pump_file::PumpFile;

/// Standard uncertainty of the engagement angle, in deg: read to 1 deg either way, rectangular, 1/sqrt(3) (GUM,
/// JCGM 100:2008, 4.3.7). Two sets of dimensions of the paper's one pump differ by 0.7 deg in the angle of full
/// contact, 66.8 and 66.1 deg.
const ENGAGEMENT_DEG: f64 = 0.577;

/// Knowledge of a pump's pulse, by which pumps with other pulses are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PulseErrors {
    /// Standard uncertainty of the roller volume, in mL.
    pub(crate) roller_volume_ml: f64,
    /// Standard uncertainty of the zero of the angle, in rad.
    pub(super) zero_standard_rad: f64,
    /// Joint uncertainty that short doses left, in place of all others.
    pub(super) fitted: Option<PulseSureness>,
    /// Angle of the model at which the corrected pump's angles begin, in rad.
    pub(super) zero_rad: f64,
}

impl PulseErrors {
    /// Returns what short doses found of the pulse, or else what the pump file states. `applied` is the correction of
    /// the pump.
    pub(crate) fn of(file: &PumpFile, applied: Option<&Applied>) -> Self {
        let zero_standard_rad = applied.map_or(0.0, |applied| applied.zero_standard_rad);
        let by_default =
            file.pulse_prior().map(|prior| PulseSureness::of_default(prior.covariances(), zero_standard_rad));
        Self {
            roller_volume_ml: file.uncertainty.roller_standard_ml(),
            zero_standard_rad,
            fitted: applied.and_then(|applied| applied.pulse).or(by_default),
            zero_rad: applied.map_or(0.0, |applied| applied.correction.zero_rad),
        }
    }

    /// Returns the corrected `pump` with the errors of a draw, and the error of its zero, in rad.
    ///
    /// # Errors
    ///
    /// [`ModelError`] of a pulse that no head can have.
    pub(super) fn drawn(&self, pump: &Pump, draw: &Draw) -> Result<(Pump, f64), ModelError> {
        let roller = pump.roller_volume();
        let (more_ml, more_deg, zero_rad) = match &self.fitted {
            Some(fitted) => {
                let [part, engagement_rad, zero_rad] =
                    fitted.errors([draw.roller_volume, draw.engagement, draw.zero]);
                (part * roller.total_ml(), degrees(engagement_rad), zero_rad)
            }
            None => (
                self.roller_volume_ml * draw.roller_volume,
                ENGAGEMENT_DEG * draw.engagement,
                self.zero_standard_rad * draw.zero,
            ),
        };
        // A corrected pump has scaled curves that begin at its zero. Its dimensions, where they are known, are those of
        // the model.
        let geometry = pump.geometry();
        let factor =
            if geometry.is_known() { pump.nominal_ml_rad() / geometry.nominal_ml_rad() } else { 1.0 };
        let engagement_deg = degrees(roller.engagement_rad()) + more_deg;
        let total_ml = (roller.total_ml() + more_ml) / factor;
        let roller = roller.stretched_to(engagement_deg)?.scaled_to(total_ml)?;
        let other = pump.with_roller_volume(roller)?;
        Ok((other.scaled(factor)?.shifted(self.zero_rad)?, zero_rad))
    }
}
