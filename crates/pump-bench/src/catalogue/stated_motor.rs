//! The steps of a motor as its owner states them.

use std::fmt;

use crate::pump_file::PumpFile;

/// Steps per revolution of a motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotorSteps {
    /// Steps per revolution, microsteps included.
    PerRevolution(u32),
    /// Full steps per revolution, each divided by the driver into so many microsteps.
    Microsteps {
        /// Full steps per revolution.
        full_steps: u32,
        /// Microsteps per full step.
        microsteps: u32,
    },
}

/// Motor as its owner states it.
///
/// ```
/// use pump_bench::catalogue::{MotorSteps, StatedMotor};
///
/// let steps = MotorSteps::Microsteps { full_steps: 200, microsteps: 16 };
/// let motor = StatedMotor::new(steps).with_gear(3.0);
/// assert_eq!(
///     motor.to_string(),
///     "200 full steps x 16 microsteps = 3200 steps per revolution of the motor, x gear 3 = 9600 of the head"
/// );
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedMotor {
    steps: MotorSteps,
    gear: f64,
}

impl StatedMotor {
    /// Returns the motor of these steps, without a gearbox.
    pub fn new(steps: MotorSteps) -> Self {
        Self { steps, gear: 1.0 }
    }

    /// Returns the motor with so many of its revolutions to one of the pump head.
    #[must_use]
    pub fn with_gear(self, gear: f64) -> Self {
        Self { gear, ..self }
    }

    /// Returns the steps per revolution of the motor. Steps beyond `u32` are its largest number, which no pump file
    /// takes.
    pub(crate) fn steps_per_rev(&self) -> u32 {
        match self.steps {
            MotorSteps::PerRevolution(steps) => steps,
            MotorSteps::Microsteps { full_steps, microsteps } => full_steps.saturating_mul(microsteps),
        }
    }

    /// Writes the motor into a pump file. Its steps are confirmed from then on: their owner has stated them. Nobody has
    /// stated which way it turns.
    pub fn write_to(&self, file: &mut PumpFile) {
        file.motor.steps_per_rev = self.steps_per_rev();
        file.motor.gear = self.gear;
        if let MotorSteps::Microsteps { full_steps, .. } = self.steps {
            file.motor.full_steps_per_rev = full_steps;
        }
        file.motor.confirmed = None;
        file.motor.direction_confirmed = Some(false);
    }
}

impl fmt::Display for StatedMotor {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let MotorSteps::Microsteps { full_steps, microsteps } = self.steps {
            write!(to, "{full_steps} full steps x {microsteps} microsteps = ")?;
        }
        let steps_per_rev = self.steps_per_rev();
        let of_head = f64::from(steps_per_rev) * self.gear;
        write!(
            to,
            "{steps_per_rev} steps per revolution of the motor, x gear {} = {of_head} of the head",
            self.gear
        )
    }
}
