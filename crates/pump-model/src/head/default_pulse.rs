//! The default pulse of a head of which only the volume of a revolution and the number of rollers are known.

use crate::error::{Allowed, ModelError, Parameter, refused, within};
use crate::math::polynomial::Polynomial;
use crate::units::{TURN_RAD, degrees, radians};

use super::roller_volume::RollerVolume;

/// Shape of the default pulse: V/V_r over u = x/phi, lowest order first. It is 3 u² - 2 u³ + u² (1 - u)² (A + B u),
/// so that the flow has no jump at either end. A and B are the least-squares fit to the drawings of
/// `examples/pulse_prior`.
pub(crate) const SHAPE: [f64; 6] =
    [0.0, 0.0, 3.0 + SHAPE_A, SHAPE_B - 2.0 * SHAPE_A - 2.0, SHAPE_A - 2.0 * SHAPE_B, SHAPE_B];

/// A of [`SHAPE`].
const SHAPE_A: f64 = 0.0;

/// B of [`SHAPE`].
const SHAPE_B: f64 = 0.0;

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

    /// Returns the engagement angle phi, degrees.
    pub fn engagement_deg(&self) -> f64 {
        degrees(self.engagement_rad)
    }

    /// Returns the roller volume of this pulse in a head that delivers `pitch_ml` a pitch.
    ///
    /// # Errors
    ///
    /// Refuses a share that is not between 0 and 1, and an engagement angle outside 0 to 360 degrees.
    pub(crate) fn roller_volume(&self, pitch_ml: f64) -> Result<RollerVolume, ModelError> {
        if !(self.share > 0.0 && self.share < 1.0) {
            return Err(refused(Parameter::PulseShare, self.share, "more than 0, less than 1"));
        }
        within(Parameter::EngagementAngle, degrees(self.engagement_rad), Allowed::POSITIVE)?;
        within(Parameter::EngagementAngle, degrees(self.engagement_rad), 0.0..360.0)?;
        let total_ml = pitch_ml * self.share / (1.0 - self.share);
        let mut curve = RollerVolume::empty(self.engagement_rad, 0.0);
        let volume = Polynomial { c: SHAPE }.stretched(1.0 / self.engagement_rad).scaled(total_ml);
        curve.push(0.0, self.engagement_rad, Some(volume));
        Ok(curve)
    }
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
        let shape = Polynomial { c: SHAPE };
        let slope = shape.derivative();
        for (found, expected) in
            [(shape.at(0.0), 0.0), (shape.at(1.0), 1.0), (slope.at(0.0), 0.0), (slope.at(1.0), 0.0)]
        {
            assert!((found - expected).abs() < 1e-14, "{found}");
        }
        assert!((1..1000).all(|n| slope.at(f64::from(n) * 1e-3) > 0.0));
    }
}
