//! A roller volume from measured points, and how well it meets them.

use crate::error::{Allowed, ModelError, refused, within};
use crate::head::geometry::Geometry;
use crate::head::roller_volume::RollerVolume;
use crate::math::polynomial::{DEGREE, Polynomial};
use crate::math::{TURN_RAD, degrees, radians, sqrt};

use super::least_squares;
use super::monotone_spline::Knots;

/// A volume measured while a roller engages.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VolumePoint {
    /// Angle since the first contact, deg, 0 to less than 360.
    pub angle_deg: f64,
    /// Volume displaced since then, mL.
    pub volume_ml: f64,
}

pub use crate::head::paper::VOLUME_POINTS as PUBLISHED_POINTS;

/// A curve through measured points, of one run or of several together, in any order. The smallest angle is the first
/// contact, 0, and the largest is phi.
///
/// ```
/// use pump_model::{VolumeFit, VolumePoint, volume_fit::PUBLISHED_POINTS};
/// let points = PUBLISHED_POINTS.map(|(angle_deg, volume_ml)| VolumePoint { angle_deg, volume_ml });
/// let fit = VolumeFit::quintic(&points)?;
/// assert!((fit.rms_ml() - 0.0074).abs() < 5e-5);
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeFit<'a> {
    points: &'a [VolumePoint],
    curve: RollerVolume,
    /// The quintic, mL over deg, where there is one.
    polynomial: Option<Polynomial>,
}

impl<'a> VolumeFit<'a> {
    /// By least squares of 5th order, as McIntyre et al. do it; where the polynomial falls the volume is held. It
    /// smooths what scatters, and jumps a little where the roller has fully engaged.
    ///
    /// Needs six different angles at least.
    pub fn quintic(points: &'a [VolumePoint]) -> Result<Self, ModelError> {
        let engagement_deg = checked(points, DEGREE + 1)?;
        // Over -1 to 1, where the powers are of one size.
        let (half, pairs) =
            (0.5 * engagement_deg, points.iter().map(|point| (point.angle_deg, point.volume_ml)));
        let unit = least_squares::quintic(pairs.map(|(deg, ml)| (deg / half - 1.0, ml)));
        let polynomial = unit.shifted(-1.0).stretched(1.0 / half);
        let mut highest_first = polynomial.c;
        highest_first.reverse();
        let curve = RollerVolume::from_polynomial_deg(highest_first, engagement_deg)?;
        Ok(Self { points, curve, polynomial: Some(polynomial) })
    }

    /// By a rising cubic spline through the mean volume of every angle, whose slope is continuous and 0 at both ends:
    /// the flow has no jump. Means that fall are pooled with their neighbours ([`Self::falls`]).
    ///
    /// Takes 3 to 25 different angles.
    pub fn spline(points: &'a [VolumePoint]) -> Result<Self, ModelError> {
        let engagement_deg = checked(points, 3)?;
        let curve = knots(points)?.spline()?;
        if curve.total_ml() > 0.0 {
            Ok(Self { points, curve, polynomial: None })
        } else {
            Err(ModelError::RollerVolumeFlat { engagement_deg })
        }
    }

    /// The curve, from V(0) = 0.
    pub fn curve(&self) -> &RollerVolume {
        &self.curve
    }

    /// Coefficients of the quintic, mL over deg, highest order first; none of a spline.
    pub fn polynomial_ml_deg(&self) -> Option<[f64; DEGREE + 1]> {
        self.polynomial.map(|polynomial| {
            let mut c = polynomial.c;
            c.reverse();
            c
        })
    }

    /// The fit less what was measured, mL, of each point in their order. A quintic's are those of the polynomial
    /// itself, which need not be 0 at angle 0.
    pub fn residuals_ml(&self) -> impl Iterator<Item = f64> {
        self.points.iter().map(|point| {
            let fitted = match &self.polynomial {
                Some(polynomial) => polynomial.at(point.angle_deg),
                None => self.curve.at(radians(point.angle_deg)),
            };
            fitted - point.volume_ml
        })
    }

    /// Root of the mean square of the residuals, mL.
    pub fn rms_ml(&self) -> f64 {
        let square: f64 = self.residuals_ml().map(|residual| residual * residual).sum();
        sqrt(square / self.points.len() as f64)
    }

    /// Where the measured volumes fall from one angle to the next: both angles, deg, and by how much, mL, volumes at
    /// the same angle averaged first. It is scatter or a slip of the pen. Takes 25 different angles at most.
    pub fn falls(&self) -> Result<impl Iterator<Item = (f64, f64, f64)>, ModelError> {
        let falls = knots(self.points)?.into_falls();
        Ok(falls.map(|(from, to, fall_ml)| (degrees(from), degrees(to), fall_ml)))
    }

    /// Stretches where the fit does not rise, deg: from, to. There the volume is held and the flow is that between the
    /// rollers.
    pub fn held_deg(&self) -> impl Iterator<Item = (f64, f64)> {
        self.curve.held_rad().map(|(from, to)| (degrees(from), degrees(to)))
    }

    /// V_rot = V_nom - NU V_r, mL per revolution of a pump with these dimensions.
    pub fn revolution_ml(&self, geometry: &Geometry) -> f64 {
        TURN_RAD * geometry.nominal_ml_rad() - f64::from(geometry.rollers) * self.curve.total_ml()
    }
}

fn knots(points: &[VolumePoint]) -> Result<Knots, ModelError> {
    Knots::of(points.iter().map(|point| (radians(point.angle_deg), point.volume_ml)))
}

/// The largest angle, deg, of points that can be fitted.
fn checked(points: &[VolumePoint], needed: usize) -> Result<f64, ModelError> {
    let (mut smallest, mut largest) = (f64::INFINITY, 0.0);
    for &VolumePoint { angle_deg, volume_ml } in points {
        within("measured angle in deg", angle_deg, 0.0..360.0)?;
        within("measured volume in mL", volume_ml, Allowed::FINITE)?;
        smallest = angle_deg.min(smallest);
        largest = angle_deg.max(largest);
    }
    let is_first = |n: usize, angle: f64| points.iter().take(n).all(|point| point.angle_deg != angle);
    let angles = points.iter().enumerate().filter(|(n, point)| is_first(*n, point.angle_deg)).count();
    if angles < needed {
        return Err(ModelError::TooFewPoints { angles, needed });
    }
    if smallest > 0.0 {
        return Err(refused("smallest measured angle in deg", smallest, "0, the first contact"));
    }
    Ok(largest)
}
