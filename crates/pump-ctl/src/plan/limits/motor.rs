//! The stepper motor.

use pump_model::units::TURN_RAD;

use crate::plan::words::{Allowed, PlanError};

use crate::parameter::Parameter;

/// The stepper motor, as seen at the pump head.
///
/// ```
/// use pump_ctl::plan::Motor;
///
/// // Steps per revolution, fastest speed in rad/s, largest acceleration in rad/s².
/// let motor = Motor::new(12_800.0, 17.8, 500.0);
/// assert_eq!(motor.max_acceleration_rad_s2, 500.0);
/// assert_eq!(motor.with_max_speed_rad_s(9.0).max_speed_rad_s, 9.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Motor {
    /// Steps per revolution of the pump head, gear included, 4 to 1e9.
    pub steps_per_rev: f64,
    /// Fastest speed of the pump head, rad/s, 1e-9 to 1e4.
    pub max_speed_rad_s: f64,
    /// Largest acceleration of the pump head, rad/s², 1e-6 to 1e7.
    pub max_acceleration_rad_s2: f64,
}

impl Motor {
    /// Makes a motor from its steps per revolution, its fastest speed and its largest acceleration.
    pub const fn new(steps_per_rev: f64, max_speed_rad_s: f64, max_acceleration_rad_s2: f64) -> Self {
        Self { steps_per_rev, max_speed_rad_s, max_acceleration_rad_s2 }
    }

    /// Returns the motor with other steps per revolution.
    #[must_use]
    pub const fn with_steps_per_rev(self, steps_per_rev: f64) -> Self {
        Self { steps_per_rev, ..self }
    }

    /// Returns the motor with another fastest speed, rad/s.
    #[must_use]
    pub const fn with_max_speed_rad_s(self, max_speed_rad_s: f64) -> Self {
        Self { max_speed_rad_s, ..self }
    }

    /// Returns the motor with another largest acceleration, rad/s².
    #[must_use]
    pub const fn with_max_acceleration_rad_s2(self, max_acceleration_rad_s2: f64) -> Self {
        Self { max_acceleration_rad_s2, ..self }
    }

    /// Returns the angle of a step, rad.
    pub fn step_rad(&self) -> f64 {
        TURN_RAD / self.steps_per_rev
    }

    pub(in crate::plan) fn validate(&self) -> Result<(), PlanError> {
        let refused = |(parameter, value, allowed)| PlanError::OutOfRange { parameter, value, allowed };
        self.in_range().map_err(refused)
    }

    /// Fails with the name, the value and the range of a value that is out of its range.
    pub(super) fn in_range(&self) -> Result<(), (Parameter, f64, Allowed)> {
        let ranges = [
            (Parameter::StepsPerRev, self.steps_per_rev, Allowed::Between { least: 4.0, most: 1e9 }),
            (Parameter::LargestSpeed, self.max_speed_rad_s, Allowed::Between { least: 1e-9, most: 1e4 }),
            (
                Parameter::LargestAcceleration,
                self.max_acceleration_rad_s2,
                Allowed::Between { least: 1e-6, most: 1e7 },
            ),
        ];
        ranges.into_iter().find(|(_, value, allowed)| !allowed.admits(*value)).map_or(Ok(()), Err)
    }
}
