//! The stepper motor.

use pump_model::math::TURN_RAD;

use crate::plan::words::{Allowed, PlanError, within};

/// The stepper motor, as seen at the pump head.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Motor {
    /// Steps per revolution of the pump head, gear included, 4 to 1e9.
    pub steps_per_rev: f64,
    /// Fastest speed of the pump head, rad/s, 1e-9 to 1e4.
    pub max_speed_rad_s: f64,
    /// Largest acceleration of the pump head, rad/s², 1e-6 to 1e7.
    pub max_acceleration_rad_s2: f64,
}

impl Motor {
    /// Returns the angle of a step, rad.
    pub fn step_rad(&self) -> f64 {
        TURN_RAD / self.steps_per_rev
    }

    pub(super) fn validate(&self) -> Result<(), PlanError> {
        let Self { steps_per_rev, max_speed_rad_s, max_acceleration_rad_s2 } = *self;
        within("steps per revolution", steps_per_rev, Allowed::Between { least: 4.0, most: 1e9 })?;
        within("largest speed in rad/s", max_speed_rad_s, Allowed::Between { least: 1e-9, most: 1e4 })?;
        let accelerations = Allowed::Between { least: 1e-6, most: 1e7 };
        within("largest acceleration in rad/s2", max_acceleration_rad_s2, accelerations)
    }
}
