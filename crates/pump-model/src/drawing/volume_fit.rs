//! Roller volumes from measured points, and the deviations of the points from them.

use libm::sqrt;

use crate::error::{Allowed, ModelError, Parameter, refused, within};
use crate::head::geometry::Geometry;
use crate::head::roller_volume::RollerVolume;
use crate::math::polynomial::{DEGREE, Polynomial};
use crate::units::{TURN_RAD, degrees, radians};

use super::least_squares;
use super::monotone_spline::Knots;

/// A volume measured while a roller engages.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VolumePoint {
    /// Angle since the first contact, deg, 0 to less than 360.
    pub angle_deg: f64,
    /// Volume displaced since the first contact, mL.
    pub volume_ml: f64,
}

pub use crate::head::paper::VOLUME_POINTS as PUBLISHED_POINTS;

/// A curve through measured points of one run or of several together, in any order. The smallest angle is the
/// first contact, 0, and the largest is phi.
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
    /// Coefficients of the quintic, mL over deg; none for a spline.
    polynomial: Option<Polynomial>,
}

impl<'a> VolumeFit<'a> {
    /// Fits a polynomial of 5th order by least squares, as McIntyre et al. do.
    ///
    /// Where the polynomial falls the volume is held. The fit smooths scatter, and jumps a little where the
    /// roller has fully engaged.
    ///
    /// # Errors
    ///
    /// Refuses fewer than six different angles, values outside their ranges, points that do not start at
    /// angle 0, and a curve that does not rise.
    pub fn quintic(points: &'a [VolumePoint]) -> Result<Self, ModelError> {
        let engagement_deg = checked(points, DEGREE + 1)?;
        // The angles run over -1 to 1, where the powers are of one size.
        let (half, pairs) =
            (0.5 * engagement_deg, points.iter().map(|point| (point.angle_deg, point.volume_ml)));
        let unit = least_squares::quintic(pairs.map(|(deg, ml)| (deg / half - 1.0, ml)));
        let polynomial = unit.shifted(-1.0).stretched(1.0 / half);
        let mut highest_first = polynomial.c;
        highest_first.reverse();
        let curve = RollerVolume::from_polynomial_deg(highest_first, engagement_deg)?;
        Ok(Self { points, curve, polynomial: Some(polynomial) })
    }

    /// Fits a rising cubic spline through the mean volume of every angle.
    ///
    /// The spline's slope is continuous and 0 at both ends, so the flow has no jump. Means that fall are
    /// pooled with their neighbours ([`Self::falls`]).
    ///
    /// # Errors
    ///
    /// Takes 3 to 25 different angles and refuses others. Also refuses values outside their ranges, points
    /// that do not start at angle 0, and a curve that does not rise.
    pub fn spline(points: &'a [VolumePoint]) -> Result<Self, ModelError> {
        let engagement_deg = checked(points, 3)?;
        let curve = knots(points)?.spline()?;
        if curve.total_ml() > 0.0 {
            Ok(Self { points, curve, polynomial: None })
        } else {
            Err(ModelError::RollerVolumeFlat { engagement_deg })
        }
    }

    /// Returns the fitted curve, from V(0) = 0.
    pub fn curve(&self) -> &RollerVolume {
        &self.curve
    }

    /// Returns the coefficients of the quintic, mL over deg, highest order first; none for a spline.
    pub fn polynomial_ml_deg(&self) -> Option<[f64; DEGREE + 1]> {
        self.polynomial.map(|polynomial| {
            let mut c = polynomial.c;
            c.reverse();
            c
        })
    }

    /// Returns the fitted less the measured volume of each point, mL, in the order of the points. The
    /// residuals of a quintic are those of the polynomial itself, which need not be 0 at angle 0.
    pub fn residuals_ml(&self) -> impl ExactSizeIterator<Item = f64> {
        self.points.iter().map(|point| {
            let fitted = match &self.polynomial {
                Some(polynomial) => polynomial.at(point.angle_deg),
                None => self.curve.at(radians(point.angle_deg)),
            };
            fitted - point.volume_ml
        })
    }

    /// Returns the root of the mean square of the residuals, mL.
    pub fn rms_ml(&self) -> f64 {
        let square: f64 = self.residuals_ml().map(|residual| residual * residual).sum();
        sqrt(square / self.points.len() as f64)
    }

    /// Returns the places at which the measured volumes fall: both angles, deg, and the fall, mL.
    ///
    /// Volumes at the same angle are averaged first. A fall is scatter or a slip of the pen.
    ///
    /// # Errors
    ///
    /// Refuses more than 25 different angles.
    pub fn falls(&self) -> Result<impl Iterator<Item = (f64, f64, f64)>, ModelError> {
        let falls = knots(self.points)?.into_falls();
        Ok(falls.map(|(from, to, fall_ml)| (degrees(from), degrees(to), fall_ml)))
    }

    /// Returns the stretches in which the fit does not rise, deg: from, to. There the volume is held, and the
    /// flow is that between the rollers.
    pub fn held_deg(&self) -> impl Iterator<Item = (f64, f64)> {
        self.curve.held_rad().map(|(from, to)| (degrees(from), degrees(to)))
    }

    /// Returns the volume of a revolution of a pump with these dimensions, mL: V_rot = V_nom - NU V_r.
    pub fn revolution_ml(&self, geometry: &Geometry) -> f64 {
        TURN_RAD * geometry.nominal_ml_rad() - f64::from(geometry.rollers) * self.curve.total_ml()
    }
}

fn knots(points: &[VolumePoint]) -> Result<Knots, ModelError> {
    Knots::of(points.iter().map(|point| (radians(point.angle_deg), point.volume_ml)))
}

/// Returns the largest angle of points that can be fitted, deg.
fn checked(points: &[VolumePoint], needed: usize) -> Result<f64, ModelError> {
    let (mut smallest, mut largest) = (f64::INFINITY, 0.0);
    for &VolumePoint { angle_deg, volume_ml } in points {
        within(Parameter::MeasuredAngle, angle_deg, 0.0..360.0)?;
        within(Parameter::MeasuredVolume, volume_ml, Allowed::FINITE)?;
        smallest = angle_deg.min(smallest);
        largest = angle_deg.max(largest);
    }
    let is_first = |n: usize, angle: f64| points.iter().take(n).all(|point| point.angle_deg != angle);
    let angles = points.iter().enumerate().filter(|(n, point)| is_first(*n, point.angle_deg)).count();
    if angles < needed {
        return Err(ModelError::TooFewPoints { angles, needed });
    }
    if smallest > 0.0 {
        return Err(refused(Parameter::SmallestMeasuredAngle, smallest, "0, the first contact"));
    }
    Ok(largest)
}
