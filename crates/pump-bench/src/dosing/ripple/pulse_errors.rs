//! Errors of a pump's pulse: roller volume, engagement angle and zero.

use pump_model::units::degrees;
use pump_model::{ModelError, Pump};

use super::errors::Draw;
use super::other_pump::{ENGAGEMENT_DEG, other_pump};
use crate::calibration::{Applied, PulseSureness};
use crate::pump_file::PumpFile;

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
        let (more_ml, more_deg, zero_rad) = match &self.fitted {
            Some(fitted) => {
                let [part, engagement_rad, zero_rad] =
                    fitted.errors([draw.roller_volume, draw.engagement, draw.zero]);
                (part * pump.roller_volume().total_ml(), degrees(engagement_rad), zero_rad)
            }
            None => (
                self.roller_volume_ml * draw.roller_volume,
                ENGAGEMENT_DEG * draw.engagement,
                self.zero_standard_rad * draw.zero,
            ),
        };
        Ok((other_pump(pump, more_ml, more_deg, self.zero_rad)?, zero_rad))
    }
}
