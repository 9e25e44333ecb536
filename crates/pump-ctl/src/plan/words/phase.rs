//! The angle at which the rollers stand.

use pump_model::units::TURN_RAD;
use pump_model::{Allowed, Pump};

use crate::parameter::Parameter;

use super::error::{PlanError, within};

/// Half width below which an angle counts as stated, rad: 2 deg.
///
/// A person reads an angle off a head to about 1 deg. Within 2 deg the flow of a pulse hardly bends, so the
/// stated angle is the most probable one and its volume lies near the middle of all volumes. Beyond, as after a
/// rotor was let go, the worst case counts.
const STATED_RAD: f64 = TURN_RAD / 180.0;

/// Angle of the rotor, and the uncertainty of that angle.
///
/// The angle counts from the model's zero, at which a roller begins to leave the outlet.
///
/// A dose from an angle that is known to less than 2 deg is planned from that angle, as if it were exact
/// ([`Self::is_stated`]). The half width then widens the range of its volume, its ripple and the angles at which
/// its limits are checked. A dose from an angle that is known less well is planned for the worst case.
///
/// ```
/// use pump_ctl::plan::Phase;
///
/// let pump = pump_model::Pump::three_roller();
/// let within_a_step = Phase::within(0.3, 0.0005);
/// let (least_ml, most_ml) = within_a_step.range_ml(&pump, 1.0);
/// assert!(least_ml < most_ml && most_ml - least_ml < 0.01);
/// assert!(within_a_step.is_known(pump.pitch_rad()));
/// assert!(!Phase::unknown(pump.pitch_rad()).is_known(pump.pitch_rad()));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Phase {
    pub(in crate::plan) angle_rad: f64,
    pub(in crate::plan) half_width_rad: f64,
}

impl Phase {
    /// Makes a phase of an angle that is known exactly.
    pub const fn known(angle_rad: f64) -> Self {
        Self { angle_rad, half_width_rad: 0.0 }
    }

    /// Makes a phase whose true angle lies within `half_width_rad` of `angle_rad`, on either side. The half
    /// width is not negative: [`Self::validate`] and every plan refuse another.
    pub const fn within(angle_rad: f64, half_width_rad: f64) -> Self {
        Self { angle_rad, half_width_rad }
    }

    /// Makes a phase that may be any angle, for a pump of this pitch. Its middle is 0.
    pub fn unknown(pitch_rad: f64) -> Self {
        Self { angle_rad: 0.0, half_width_rad: 0.5 * pitch_rad }
    }

    /// Makes the phase of a rotor that has made `steps` signed steps since its index sensor became active at
    /// `index_rad`. A step is `step_rad`, and the angle is known to half a step.
    ///
    /// ```
    /// use pump_ctl::plan::{Motor, Phase};
    ///
    /// let motor = Motor::new(360.0, 1.0, 1.0);
    /// // The position is 110 now, and was 100 at the index, which stands at 40 degrees.
    /// let phase = Phase::from_index(40_f64.to_radians(), 110 - 100, motor.step_rad());
    /// assert!((phase.angle_rad() - 50_f64.to_radians()).abs() < 1e-12);
    /// assert_eq!(phase.half_width_rad(), 0.5 * motor.step_rad());
    /// ```
    pub fn from_index(index_rad: f64, steps: i64, step_rad: f64) -> Self {
        Self { angle_rad: index_rad + steps as f64 * step_rad, half_width_rad: 0.5 * step_rad }
    }

    /// Returns the angle, rad. Only the angle within a pitch matters.
    pub const fn angle_rad(&self) -> f64 {
        self.angle_rad
    }

    /// Returns the half width, rad: the largest distance of the true angle from [`Self::angle_rad`].
    pub const fn half_width_rad(&self) -> f64 {
        self.half_width_rad
    }

    /// Returns the phase at another angle, as well known as this one.
    #[must_use]
    pub const fn moved_to(self, angle_rad: f64) -> Self {
        Self { angle_rad, ..self }
    }

    /// Returns true if the angle is known to less than a whole pitch, for a pump of this pitch.
    pub fn is_known(&self, pitch_rad: f64) -> bool {
        self.half_width_rad < 0.5 * pitch_rad
    }

    /// Returns true if the angle is known to less than 2 deg, so that doses are planned from it as if it were
    /// exact.
    ///
    /// ```
    /// use pump_ctl::plan::Phase;
    ///
    /// assert!(Phase::within(0.5, 1_f64.to_radians()).is_stated());
    /// assert!(!Phase::within(0.5, 2_f64.to_radians()).is_stated());
    /// ```
    pub fn is_stated(&self) -> bool {
        self.half_width_rad < STATED_RAD
    }

    /// Returns the angles that the steps of a dose are chosen for: a stated angle alone, or every angle at which
    /// the rollers may stand.
    pub(in crate::plan) fn aimed(self) -> Self {
        if self.is_stated() { Self::known(self.angle_rad) } else { self }
    }

    /// Returns the smallest and the largest volume, mL, that a turn by `turn_rad` delivers, over the angles
    /// at which the rollers may stand.
    pub fn range_ml(&self, pump: &Pump, turn_rad: f64) -> (f64, f64) {
        pump.outlet_curve().turn_range_ml(self.angle_rad, self.half_width_rad, turn_rad)
    }

    /// Refuses an angle or a half width that no rotor has.
    ///
    /// # Errors
    /// [`PlanError::OutOfRange`] with the parameter, its value and the allowed range.
    pub fn validate(&self) -> Result<(), PlanError> {
        within(Parameter::StartAngle, self.angle_rad, Allowed::EitherWay { most: 1e6 })?;
        within(Parameter::StartHalfWidth, self.half_width_rad, Allowed::NotNegative)
    }
}
