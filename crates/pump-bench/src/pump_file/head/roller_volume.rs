//! `[roller_volume]`: the volume that a roller displaces.
//!
//! It comes from a published polynomial, from the drawing or from measured points.

use pump_model::{Geometry, ModelError, RollerVolume, VolumeFit, VolumePoint};
use serde::{Deserialize, Serialize};

use crate::words::words;

/// The table `[roller_volume]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RollerVolumeKeys", into = "RollerVolumeKeys")]
pub enum RollerVolumeTable {
    /// Polynomial, as measured curves are published.
    Polynomial {
        /// Engagement angle phi, in deg.
        engagement_angle_deg: f64,
        /// Coefficients of the volume in mL over the angle in deg, highest order (5) first.
        polynomial_ml_deg: [f64; 6],
        /// Total volume V_r to which the curve is scaled, in mL. `None` keeps the polynomial's total.
        total_ml: Option<f64>,
    },
    /// Dimensions of tube, rollers and backplate, with `source = "drawing"`.
    Drawing,
    /// Measured points, with `source = "measured"`.
    Measured {
        /// Fit of the curve to the points.
        fit: CurveFit,
        /// Points: the angle since first contact in deg and the volume displaced since then in mL.
        points: Vec<VolumePoint>,
    },
}

/// A fit of a curve to measured points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CurveFit {
    /// Rising cubic spline, through the mean of each angle of 25 at most and by least squares near more. Its flow has
    /// no jumps.
    Spline,
    /// Least squares of 5th order, as in McIntyre et al.
    Quintic,
}

words!(CurveFit { Quintic = "quintic", Spline = "spline" });

impl RollerVolumeTable {
    /// Returns the volume curve of a pump with these dimensions.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of coefficients, dimensions or points from which no curve follows.
    pub(crate) fn curve(&self, geometry: &Geometry) -> Result<RollerVolume, ModelError> {
        match self {
            Self::Polynomial { engagement_angle_deg, polynomial_ml_deg, total_ml } => {
                let curve = RollerVolume::from_polynomial_deg(*polynomial_ml_deg, *engagement_angle_deg)?;
                total_ml.map_or(Ok(curve), |total_ml| curve.scaled_to(total_ml))
            }
            Self::Drawing => RollerVolume::from_drawing(geometry),
            Self::Measured { fit, points } => Ok(*fit.of(points)?.curve()),
        }
    }

    /// Returns true if the volume is estimated from the drawing and not measured.
    pub(crate) fn is_estimated(&self) -> bool {
        *self == Self::Drawing
    }
}

impl CurveFit {
    /// Fits the curve to these points.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of points that cannot be fitted.
    pub fn of(self, points: &[VolumePoint]) -> Result<VolumeFit<'_>, ModelError> {
        match self {
            Self::Spline => VolumeFit::spline(points),
            Self::Quintic => VolumeFit::quintic(points),
        }
    }
}

/// The source of a roller volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum VolumeSource {
    #[default]
    Polynomial,
    Drawing,
    Measured,
}

/// Keys of the table, of all sources together.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RollerVolumeKeys {
    #[serde(default, skip_serializing_if = "is_polynomial")]
    source: VolumeSource,
    #[serde(skip_serializing_if = "Option::is_none")]
    engagement_angle_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    polynomial_ml_deg: Option<[f64; 6]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    total_ml: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fit: Option<CurveFit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    points_deg_ml: Option<Vec<[f64; 2]>>,
}

/// Returns true for the default source, which a pump file leaves out.
fn is_polynomial(source: &VolumeSource) -> bool {
    *source == VolumeSource::Polynomial
}

impl TryFrom<RollerVolumeKeys> for RollerVolumeTable {
    type Error = String;

    fn try_from(keys: RollerVolumeKeys) -> Result<Self, String> {
        let RollerVolumeKeys {
            source,
            engagement_angle_deg,
            polynomial_ml_deg,
            total_ml,
            fit,
            points_deg_ml,
        } = keys;
        let given = [
            ("engagement_angle_deg", engagement_angle_deg.is_some(), VolumeSource::Polynomial),
            ("polynomial_ml_deg", polynomial_ml_deg.is_some(), VolumeSource::Polynomial),
            ("total_ml", total_ml.is_some(), VolumeSource::Polynomial),
            ("fit", fit.is_some(), VolumeSource::Measured),
            ("points_deg_ml", points_deg_ml.is_some(), VolumeSource::Measured),
        ];
        if let Some((key, ..)) = given.iter().find(|(_, given, owner)| *given && *owner != source) {
            let source = format!("{source:?}").to_lowercase();
            return Err(format!("`{key}` means nothing with source = \"{source}\"; leave one of them out"));
        }
        let missing = |key: &str| format!("missing field `{key}`");
        Ok(match source {
            VolumeSource::Polynomial => Self::Polynomial {
                engagement_angle_deg: engagement_angle_deg.ok_or_else(|| missing("engagement_angle_deg"))?,
                polynomial_ml_deg: polynomial_ml_deg.ok_or_else(|| missing("polynomial_ml_deg"))?,
                total_ml,
            },
            VolumeSource::Drawing => Self::Drawing,
            VolumeSource::Measured => {
                let points = points_deg_ml.ok_or_else(|| missing("points_deg_ml"))?;
                let point = |[angle_deg, volume_ml]: [f64; 2]| VolumePoint { angle_deg, volume_ml };
                Self::Measured {
                    fit: fit.ok_or_else(|| missing("fit") + ": \"spline\" or \"quintic\"")?,
                    points: points.into_iter().map(point).collect(),
                }
            }
        })
    }
}

impl From<RollerVolumeTable> for RollerVolumeKeys {
    fn from(table: RollerVolumeTable) -> Self {
        match table {
            RollerVolumeTable::Polynomial { engagement_angle_deg, polynomial_ml_deg, total_ml } => Self {
                engagement_angle_deg: Some(engagement_angle_deg),
                polynomial_ml_deg: Some(polynomial_ml_deg),
                total_ml,
                ..Self::default()
            },
            RollerVolumeTable::Drawing => Self { source: VolumeSource::Drawing, ..Self::default() },
            RollerVolumeTable::Measured { fit, points } => Self {
                source: VolumeSource::Measured,
                fit: Some(fit),
                points_deg_ml: Some(points.iter().map(|point| [point.angle_deg, point.volume_ml]).collect()),
                ..Self::default()
            },
        }
    }
}
