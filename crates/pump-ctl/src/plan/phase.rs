//! Where the rollers stand.

use pump_model::Pump;
use pump_model::math::ceil;

use super::PlanError;

/// Angle of the rotor in the model's zero (a roller begins to leave the outlet), and how well it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Phase {
    /// Angle, rad. Only the angle within a pitch matters.
    pub angle_rad: f64,
    /// The true angle lies within this of it, rad, not negative.
    pub half_width_rad: f64,
}

impl Phase {
    /// An angle known exactly.
    pub fn known(angle_rad: f64) -> Self {
        Self { angle_rad, half_width_rad: 0.0 }
    }

    /// An angle of which nothing is known, for a pump of this pitch: its middle, 0, stands for all of them.
    pub fn unknown(pitch_rad: f64) -> Self {
        Self { angle_rad: 0.0, half_width_rad: 0.5 * pitch_rad }
    }

    /// False if the angle may be anything, for a pump of this pitch.
    pub fn is_known(&self, pitch_rad: f64) -> bool {
        self.half_width_rad < 0.5 * pitch_rad
    }

    /// Smallest and largest volume, mL, that a turn by `turn_rad` delivers from wherever the rollers may stand.
    pub fn range_ml(&self, pump: &Pump, turn_rad: f64) -> (f64, f64) {
        pump.outlet_curve().turn_range_ml(self.angle_rad, self.half_width_rad, turn_rad)
    }

    /// How far before and behind this angle, rad, the rollers are looked at: at the ends of where they may stand, in its
    /// middle, and between them a sixteenth of a pitch apart at most. Of an angle that is known, 0 alone.
    pub(super) fn beside(&self, pitch_rad: f64) -> impl Iterator<Item = f64> + use<> {
        let half_rad = self.half_width_rad.min(0.5 * pitch_rad);
        // 8 at most.
        let looks = ceil(16.0 * half_rad / pitch_rad) as i32;
        (-looks..=looks).map(move |n| if n == 0 { 0.0 } else { half_rad * f64::from(n) / f64::from(looks) })
    }

    pub(super) fn validate(&self) -> Result<(), PlanError> {
        if !self.angle_rad.is_finite() || self.angle_rad.abs() > 1e6 {
            return Err(PlanError::OutOfRange {
                parameter: "start angle in rad",
                value: self.angle_rad,
                allowed: "a finite angle within 1e6 rad",
            });
        }
        if !(self.half_width_rad >= 0.0 && self.half_width_rad.is_finite()) {
            return Err(PlanError::OutOfRange {
                parameter: "half width of the start angle in rad",
                value: self.half_width_rad,
                allowed: "zero or a positive number",
            });
        }
        Ok(())
    }
}
