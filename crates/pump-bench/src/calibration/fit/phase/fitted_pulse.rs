//! The pulse that short doses found, as a stored calibration has it, and how unsure it leaves a dose.

use pump_model::units::radians;
use serde::{Deserialize, Serialize};

use super::PhaseFit;
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
        PulseSureness { covariances }
    }
}

/// Joint uncertainty of a fitted pulse: covariances of V_r, as a part of it, of phi, in rad, and of the zero,
/// in rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PulseSureness {
    covariances: [[f64; 3]; 3],
}

impl PulseSureness {
    /// Returns the uncertainty of a default pulse, whose covariances are those of V_r, as a part of it, and of phi, in
    /// rad, beside that of the zero, in rad.
    pub(crate) fn of_default(covariances: [[f64; 2]; 2], zero_standard_rad: f64) -> Self {
        let [[roller, both], [_, phi]] = covariances;
        let zero = zero_standard_rad * zero_standard_rad;
        Self { covariances: [[roller, both, 0.0], [both, phi, 0.0], [0.0, 0.0, zero]] }
    }

    /// Returns the errors of V_r, as a part of it, of phi, in rad, and of the zero, in rad, that three independent
    /// normal numbers make: the product of Cholesky's factor of the covariances with the numbers.
    pub(crate) fn errors(&self, normal: [f64; 3]) -> [f64; 3] {
        let mut factor = [[0.0; 3]; 3];
        for row in 0..3 {
            for column in 0..=row {
                let sum: f64 = (0..column).map(|n| factor[row][n] * factor[column][n]).sum();
                let left = self.covariances[row][column] - sum;
                factor[row][column] = match (row == column, factor[column][column]) {
                    (true, _) => left.max(0.0).sqrt(),
                    (false, 0.0) => 0.0,
                    (false, diagonal) => left / diagonal,
                };
            }
        }
        factor.map(|row| row.iter().zip(normal).map(|(entry, number)| entry * number).sum())
    }

    /// Returns the variance of a quantity whose derivatives by V_r (over V_r), phi and zero are `slopes`
    /// (GUM, JCGM 100:2008, equation 13).
    pub(crate) fn variance(&self, slopes: [f64; 3]) -> f64 {
        let sum = |row: &[f64; 3]| row.iter().zip(slopes).map(|(covariance, slope)| covariance * slope).sum();
        let variance: f64 =
            self.covariances.iter().map(sum).zip(slopes).map(|(sum, slope): (f64, f64)| sum * slope).sum();
        variance.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_have_the_covariances_of_the_fit() {
        let covariances = [[4.0, 1.0, -2.0], [1.0, 3.0, 0.5], [-2.0, 0.5, 5.0]];
        let sureness = PulseSureness { covariances };
        let columns =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|normal| sureness.errors(normal));
        for row in 0..3 {
            for other in 0..3 {
                let sum: f64 = columns.iter().map(|column| column[row] * column[other]).sum();
                assert!((sum - covariances[row][other]).abs() < 1e-12, "{row} {other}: {sum}");
            }
        }
    }
}
