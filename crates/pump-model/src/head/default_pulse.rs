//! The default pulse of a head of which only the volume of a revolution and the number of rollers are known.

use crate::error::{Allowed, ModelError, Parameter, refused, within};
use crate::math::polynomial::Polynomial;
use crate::units::{TURN_RAD, degrees, radians};

use super::roller_volume::RollerVolume;

/// Shape of the default pulse: V/V_r and its slope over u = x/phi, at equal steps of u. It is the mean of the drawings
/// in `examples/pulse_prior`, whose test holds it to them.
const SHAPE: [(f64, f64); 11] = [
    (0.0, 0.0),
    (0.0370, 0.8553),
    (0.1714, 1.7803),
    (0.3779, 2.2597),
    (0.5980, 1.8897),
    (0.7592, 1.3184),
    (0.8691, 0.8950),
    (0.9403, 0.5407),
    (0.9798, 0.2630),
    (0.9963, 0.0883),
    (1.0, 0.0),
];

/// Geometric mean of the engagement angles of these drawings, degrees.
const ENGAGEMENT_DEG: f64 = 59.916;

/// Largest engagement angle of these drawings, as a part of the pitch. More rollers leave less room for each.
const WIDEST_PART: f64 = 0.6167;

/// Pulse of a roller as a head's flow shows it: its share of the volume between two rollers, and its angle.
///
/// The share is V_r/(V_pitch + V_r): the part of the bore's volume between two rollers that a roller takes when it
/// leaves.
///
/// ```
/// use pump_model::{DefaultPulse, Pump};
/// let pump = Pump::three_roller();
/// let pulse = DefaultPulse::of(&pump);
/// // V_r over the bore's volume of a pitch: 3 * 2.105466/27.63489.
/// assert!((pulse.share - 0.228566).abs() < 1e-6);
/// assert!((pulse.engagement_deg() - 50.53).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DefaultPulse {
    /// Share of the bore's volume between two rollers that a roller takes, between 0 and 1.
    pub share: f64,
    /// Angle of the pulse: the engagement angle phi, rad.
    pub engagement_rad: f64,
}

impl DefaultPulse {
    /// Returns the pulse with this share and this engagement angle, degrees.
    pub fn new(share: f64, engagement_deg: f64) -> Self {
        Self { share, engagement_rad: radians(engagement_deg) }
    }

    /// Mean fullness V_r/(a phi) of the drawings of heads: the part of the bore's volume over phi that a roller takes.
    pub const FULLNESS: f64 = 0.41938;

    /// Returns the engagement angle phi of a head of which only the number of rollers is known, degrees.
    pub fn usual_engagement_deg(rollers: u32) -> f64 {
        ENGAGEMENT_DEG.min(WIDEST_PART * (360.0 / f64::from(rollers.max(1))))
    }

    /// Returns the pulse of a head of which only the number of rollers is known.
    ///
    /// ```
    /// use pump_model::DefaultPulse;
    /// let pulse = DefaultPulse::of_rollers(4);
    /// // The share of a pitch is the fullness times the part of the pitch that the pulse takes.
    /// assert!((pulse.share - DefaultPulse::FULLNESS * pulse.engagement_deg() / 90.0).abs() < 1e-15);
    /// ```
    pub fn of_rollers(rollers: u32) -> Self {
        let engagement_deg = Self::usual_engagement_deg(rollers);
        Self::new(Self::FULLNESS * engagement_deg * f64::from(rollers) / 360.0, engagement_deg)
    }

    /// Returns the engagement angle phi, degrees.
    pub fn engagement_deg(&self) -> f64 {
        degrees(self.engagement_rad)
    }

    /// Returns the roller volume of this pulse in a head that delivers `pitch_ml` a pitch.
    ///
    /// # Errors
    ///
    /// Refuses a share that is not between 0 and 1, and an engagement angle outside 0 to 360 degrees.
    pub fn roller_volume(&self, pitch_ml: f64) -> Result<RollerVolume, ModelError> {
        if !(self.share > 0.0 && self.share < 1.0) {
            return Err(refused(Parameter::PulseShare, self.share, "more than 0, less than 1"));
        }
        within(Parameter::EngagementAngle, degrees(self.engagement_rad), Allowed::POSITIVE)?;
        within(Parameter::EngagementAngle, degrees(self.engagement_rad), 0.0..360.0)?;
        let total_ml = pitch_ml * self.share / (1.0 - self.share);
        let mut curve = RollerVolume::empty(self.engagement_rad, 0.0);
        let step_rad = self.engagement_rad / (SHAPE.len() - 1) as f64;
        for (n, knots) in SHAPE.windows(2).enumerate() {
            let &[from, to] = knots else { continue };
            let start_rad = step_rad * n as f64;
            let volume = cubic(from, to).stretched(1.0 / step_rad).scaled(total_ml);
            curve.push(start_rad, start_rad + step_rad, Some(volume));
        }
        Ok(curve)
    }

    /// Returns the shape of the pulse: V/V_r and its slope over x/phi, at equal steps of x/phi from 0 to 1.
    pub fn shape() -> [(f64, f64); 11] {
        SHAPE
    }
}

/// Returns the cubic over [0, 1] between two knots of the shape, up to a constant.
fn cubic(from: (f64, f64), to: (f64, f64)) -> Polynomial {
    let part = 1.0 / (SHAPE.len() - 1) as f64;
    let (rise, slope_0, slope_1) = (to.0 - from.0, from.1 * part, to.1 * part);
    let c = [0.0, slope_0, 3.0 * rise - 2.0 * slope_0 - slope_1, slope_0 + slope_1 - 2.0 * rise, 0.0, 0.0];
    Polynomial { c }
}

/// Returns the angle by which the pulse of the inlet begins behind that of the outlet in a head whose dimensions are
/// not known, rad.
///
/// The inlet is taken as the mirror of the outlet, q_in(theta) = q_out(-theta). That is psi = 2 pi - Lam - phi with a
/// roller fully engaged over whole pitches, as with three rollers of McIntyre et al. (Lam = 240 degrees).
pub(crate) fn mirror_psi_rad(rollers: u32, engagement_rad: f64) -> f64 {
    crate::units::wrap(-engagement_rad, TURN_RAD / f64::from(rollers))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shape_rises_from_nothing_to_the_whole_without_a_jump_of_the_flow() {
        let curve = DefaultPulse::new(0.5, 50.0).roller_volume(2.0).unwrap();
        assert!((curve.total_ml() - 2.0).abs() < 1e-13);
        let phi_rad = curve.engagement_rad();
        for end_rad in [1e-7, phi_rad - 1e-7] {
            assert!(curve.slope_ml_rad(end_rad) < 1e-5);
        }
        let slope = |n: u32| curve.slope_ml_rad(phi_rad * f64::from(n) * 1e-4);
        for n in 1..10_000 {
            assert!(slope(n) > 0.0 && (slope(n + 1) - slope(n)).abs() < 0.02, "{n}: {}", slope(n));
        }
    }
}
