//! The angle at which the rollers stand.

use pump_model::{Allowed, Pump};

use super::error::{PlanError, within};

/// Angle of the rotor, and the uncertainty of that angle.
///
/// The angle counts from the model's zero, at which a roller begins to leave the outlet.
///
/// ```
/// use pump_ctl::plan::Phase;
///
/// let pump = pump_model::Pump::three_roller();
/// let within_a_step = Phase { angle_rad: 0.3, half_width_rad: 0.0005 };
/// let (least_ml, most_ml) = within_a_step.range_ml(&pump, 1.0);
/// assert!(least_ml < most_ml && most_ml - least_ml < 0.01);
/// assert!(within_a_step.is_known(pump.pitch_rad()));
/// assert!(!Phase::unknown(pump.pitch_rad()).is_known(pump.pitch_rad()));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Phase {
    /// Angle, rad. Only the angle within a pitch matters.
    pub angle_rad: f64,
    /// Half width: the largest distance of the true angle from `angle_rad`, rad, not negative.
    pub half_width_rad: f64,
}

impl Phase {
    /// Makes a phase of an angle that is known exactly.
    pub fn known(angle_rad: f64) -> Self {
        Self { angle_rad, half_width_rad: 0.0 }
    }

    /// Makes a phase that may be any angle, for a pump of this pitch. Its middle is 0.
    pub fn unknown(pitch_rad: f64) -> Self {
        Self { angle_rad: 0.0, half_width_rad: 0.5 * pitch_rad }
    }

    /// Returns true if the angle is known to less than a whole pitch, for a pump of this pitch.
    pub fn is_known(&self, pitch_rad: f64) -> bool {
        self.half_width_rad < 0.5 * pitch_rad
    }

    /// Returns the smallest and the largest volume, mL, that a turn by `turn_rad` delivers, over the angles
    /// at which the rollers may stand.
    pub fn range_ml(&self, pump: &Pump, turn_rad: f64) -> (f64, f64) {
        pump.outlet_curve().turn_range_ml(self.angle_rad, self.half_width_rad, turn_rad)
    }

    pub(in crate::plan) fn validate(&self) -> Result<(), PlanError> {
        within("start angle in rad", self.angle_rad, Allowed::EitherWay { most: 1e6 })?;
        within("half width of the start angle in rad", self.half_width_rad, Allowed::NotNegative)
    }
}
