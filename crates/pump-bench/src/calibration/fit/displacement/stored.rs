//! The displacement factor as a stored calibration has it.

use std::num::NonZeroU32;

use serde::{Deserialize, Serialize};

use super::Displacement;
use crate::calibration::fit::law_fit::LawFit;
use crate::calibration::fit::prior::ScatterPrior;
use crate::calibration::fit::scatter::Scatter;
use crate::calibration::fit::speed_bend::SpeedBend;

/// Fields of a displacement factor in JSON.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Displacement", deny_unknown_fields)]
pub(super) struct StoredDisplacement {
    reference_rpm: f64,
    factor: f64,
    factor_standard: f64,
    slope_per_rpm: f64,
    slope_standard_per_rpm: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    bend: Option<SpeedBend>,
    /// Degrees of freedom; 0 exactly where there is no scatter.
    degrees_of_freedom: u32,
    scatter: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    prior: Option<ScatterPrior>,
    lack_of_fit: f64,
    reading: f64,
    speeds_rpm: Vec<f64>,
    outliers: Vec<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    speed_law: Option<LawFit>,
}

impl TryFrom<StoredDisplacement> for Displacement {
    type Error = String;

    fn try_from(stored: StoredDisplacement) -> Result<Self, String> {
        let scatter = match (NonZeroU32::new(stored.degrees_of_freedom), stored.scatter) {
            (Some(degrees_of_freedom), Some(standard)) => Scatter::Seen { degrees_of_freedom, standard },
            (None, None) => Scatter::Expected,
            (Some(count), None) => {
                return Err(format!(
                    "scatter is null with degrees_of_freedom {count}; allowed: a number, or null with \
                     degrees_of_freedom 0"
                ));
            }
            (None, Some(scatter)) => {
                return Err(format!(
                    "scatter is {scatter} with degrees_of_freedom 0; allowed: null, or a number with \
                     degrees_of_freedom of 1 or more"
                ));
            }
        };
        Ok(Self {
            reference_rpm: stored.reference_rpm,
            factor: stored.factor,
            factor_standard: stored.factor_standard,
            slope_per_rpm: stored.slope_per_rpm,
            slope_standard_per_rpm: stored.slope_standard_per_rpm,
            bend: stored.bend,
            scatter,
            prior: stored.prior,
            lack_of_fit: stored.lack_of_fit,
            reading: stored.reading,
            speeds_rpm: stored.speeds_rpm,
            outliers: stored.outliers,
            law: stored.speed_law,
        })
    }
}

impl From<Displacement> for StoredDisplacement {
    fn from(found: Displacement) -> Self {
        Self {
            reference_rpm: found.reference_rpm,
            factor: found.factor,
            factor_standard: found.factor_standard,
            slope_per_rpm: found.slope_per_rpm,
            slope_standard_per_rpm: found.slope_standard_per_rpm,
            bend: found.bend,
            degrees_of_freedom: found.scatter.degrees_of_freedom(),
            scatter: found.scatter.standard(),
            prior: found.prior,
            lack_of_fit: found.lack_of_fit,
            reading: found.reading,
            speeds_rpm: found.speeds_rpm,
            outliers: found.outliers,
            speed_law: found.law,
        }
    }
}
