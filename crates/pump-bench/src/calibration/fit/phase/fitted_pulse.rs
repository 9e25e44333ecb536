//! The pulse that short doses found, as a stored calibration has it, and how unsure it leaves a dose.

use pump_model::units::radians;
use serde::{Deserialize, Serialize};

use super::PhaseFit;
use super::pulse_sureness::PulseSureness;
use crate::calibration::fit::expected::Expected;
use crate::displacement::PulseCorrection;

/// Roller volume and engagement angle that short doses found, with their uncertainty beside the zero's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct FittedPulse {
    /// Roller volume V_r, in mL, at the pump file's volume of a revolution.
    pub roller_volume_ml: f64,
    /// Standard uncertainty of V_r, in mL.
    pub roller_volume_standard_ml: f64,
    /// Engagement angle phi, in deg.
    pub engagement_deg: f64,
    /// Standard uncertainty of phi, in deg.
    pub engagement_standard_deg: f64,
    /// Correlation coefficients of the estimates: V_r with phi, V_r with the zero, phi with the zero.
    pub(crate) correlations: [f64; 3],
    /// Standard deviation that was expected of repeated short doses, as a part of the volume.
    pub(crate) repeatability: f64,
    /// Standard uncertainty of a reading of the short doses, in mL.
    pub(crate) reading_ml: f64,
}

impl FittedPulse {
    pub(crate) fn of(found: &PhaseFit, expected: &Expected) -> Self {
        Self {
            roller_volume_ml: found.roller_volume_ml.value,
            roller_volume_standard_ml: found.roller_volume_ml.standard,
            engagement_deg: found.engagement_deg.value,
            engagement_standard_deg: found.engagement_deg.standard,
            correlations: found.correlations,
            repeatability: expected.repeatability,
            reading_ml: expected.reading_ml,
        }
    }

    /// Returns the pulse as a correction of the pump.
    pub(crate) fn correction(&self) -> PulseCorrection {
        let Self { roller_volume_ml, engagement_deg, .. } = *self;
        PulseCorrection { roller_volume_ml, engagement_deg }
    }

    /// Returns the uncertainty that the short doses were expected to have.
    pub(crate) fn expected(&self) -> Expected {
        Expected::new(self.repeatability, self.reading_ml)
    }

    /// Returns the uncertainty of the pulse beside a zero of this standard uncertainty, in deg.
    pub(crate) fn sureness(&self, zero_standard_deg: f64) -> PulseSureness {
        let standards = [
            self.roller_volume_standard_ml / self.roller_volume_ml,
            radians(self.engagement_standard_deg),
            radians(zero_standard_deg),
        ];
        let [roller_phi, roller_zero, phi_zero] = self.correlations;
        let of_pair =
            [[1.0, roller_phi, roller_zero], [roller_phi, 1.0, phi_zero], [roller_zero, phi_zero, 1.0]];
        let covariances = core::array::from_fn(|row: usize| {
            core::array::from_fn(|n: usize| of_pair[row][n] * standards[row] * standards[n])
        });
        PulseSureness::new(covariances)
    }
}
