//! Roller volumes from measured points, and the deviations of the points from them.

use libm::sqrt;

use crate::error::{Allowed, ModelError, Parameter, refused, within};
use crate::head::geometry::Geometry;
use crate::head::roller_volume::RollerVolume;
use crate::math::polynomial::{DEGREE, Polynomial};
use crate::units::{TURN_RAD, degrees, radians};

use super::monotone_spline::{Knots, MAX_KNOTS};
use super::{least_squares, smoothing_spline};

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
        let (engagement_deg, _) = checked(points, DEGREE + 1)?;
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

    /// Fits a rising cubic spline, whose slope is continuous and 0 at both ends, so that the flow has no jump.
    ///
    /// The spline goes through the mean volume of every angle of 25 at most. Means that fall are pooled with
    /// their neighbours ([`Self::falls`]).
    ///
    /// Near more angles it is the cubic spline from V(0) = 0 with the least sum of squares (de Boor, "A
    /// Practical Guide to Splines", chapter XIV). It has 25 knots at most, at the angles next to even divisions
    /// of phi: clusters of points draw no knots, and a stretch without points has none. Volumes at knots that
    /// fall are pooled, and slopes that would make the volume fall are reduced. Scatter is smoothed, so a curve
    /// with features within 1/24 of phi lies off its points ([`Self::residuals_ml`]).
    ///
    /// # Errors
    ///
    /// Refuses fewer than three different angles, values outside their ranges, points that do not start at
    /// angle 0, and a curve that does not rise.
    ///
    /// # Examples
    ///
    /// ```
    /// use pump_model::{VolumeFit, VolumePoint};
    /// let points: Vec<_> = (0..=500)
    ///     .map(|n| f64::from(n) * 0.1)
    ///     .map(|angle_deg: f64| VolumePoint {
    ///         angle_deg,
    ///         volume_ml: 1.0 - (angle_deg / 50.0 * core::f64::consts::PI).cos(),
    ///     })
    ///     .collect();
    /// let fit = VolumeFit::spline(&points)?;
    /// assert!((fit.curve().total_ml() - 2.0).abs() < 1e-5 && fit.rms_ml() < 1e-5);
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn spline(points: &'a [VolumePoint]) -> Result<Self, ModelError> {
        let (engagement_deg, angles) = checked(points, 3)?;
        let curve = if angles > MAX_KNOTS {
            smoothing_spline::knots(in_rad(points), radians(engagement_deg)).fitted_spline()?
        } else {
            Knots::of(in_rad(points))?.spline()?
        };
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
        let falls = Knots::of(in_rad(self.points))?.into_falls();
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

/// Returns the points in rad and mL.
fn in_rad(points: &[VolumePoint]) -> impl Iterator<Item = (f64, f64)> + Clone {
    points.iter().map(|point| (radians(point.angle_deg), point.volume_ml))
}

/// Returns the largest angle of points that can be fitted, deg, and the number of different angles up to one more
/// than a spline has knots.
fn checked(points: &[VolumePoint], needed: usize) -> Result<(f64, usize), ModelError> {
    let (mut smallest, mut largest) = (f64::INFINITY, 0.0);
    for &VolumePoint { angle_deg, volume_ml } in points {
        within(Parameter::MeasuredAngle, angle_deg, 0.0..360.0)?;
        within(Parameter::MeasuredVolume, volume_ml, Allowed::FINITE)?;
        smallest = angle_deg.min(smallest);
        largest = angle_deg.max(largest);
    }
    let is_first = |n: usize, angle: f64| points.iter().take(n).all(|point| point.angle_deg != angle);
    let different = points.iter().enumerate().filter(|(n, point)| is_first(*n, point.angle_deg));
    let angles = different.take(MAX_KNOTS + 1).count();
    if angles < needed {
        return Err(ModelError::TooFewPoints { angles, needed });
    }
    if smallest > 0.0 {
        return Err(refused(Parameter::SmallestMeasuredAngle, smallest, "0, the first contact"));
    }
    Ok((largest, angles))
}
