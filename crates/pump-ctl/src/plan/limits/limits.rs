//! The limits of a dose.

use super::motor::Motor;
use super::pressure_limits::{Lowest, PressureLimits};
use super::torque::Torque;
use crate::plan::words::{PlanError, SetBy};

/// Limits of the motor and, where given, of the pressures and the torque.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Limits {
    /// Steps, speed and acceleration.
    pub motor: Motor,
    /// Pressures that somebody has set.
    pub pressures: PressureLimits,
    /// Smallest pressure that tube and fluid stand, at either port, since a long outlet line runs on when the rotor
    /// stops. None is not checked.
    pub lowest: Option<Lowest>,
    /// Torque that turning takes, and torque that the motor has; none is not checked.
    pub torque: Option<Torque>,
}

impl Limits {
    /// The limits of the motor alone.
    pub const fn of_motor(motor: Motor) -> Self {
        Self { motor, pressures: PressureLimits::NONE, lowest: None, torque: None }
    }

    /// The smallest pressure that is allowed at the port that sucks: the larger of the given limit and the pressure
    /// that tube and fluid stand.
    pub fn lowest_where_it_sucks(&self) -> Option<Lowest> {
        let given = self.pressures.min_inlet_kpa.map(|kpa| Lowest { kpa, set_by: SetBy::Given });
        given.into_iter().chain(self.lowest).max_by(|a, b| a.kpa.total_cmp(&b.kpa))
    }

    /// Tells whether anything but speed and acceleration is limited.
    pub(in crate::plan) fn are_predicted(&self) -> bool {
        self.pressures.max_outlet_kpa.is_some()
            || self.lowest_where_it_sucks().is_some()
            || self.torque.is_some()
    }

    /// Refuses limits that mean nothing.
    ///
    /// # Errors
    ///
    /// Fails with [`PlanError::OutOfRange`], which names the limit, its value and the allowed range.
    pub fn validate(&self) -> Result<(), PlanError> {
        self.motor.validate()?;
        self.pressures.validate()?;
        if let Some(lowest) = self.lowest {
            lowest.validate()?;
        }
        if let Some(torque) = &self.torque {
            torque.validate()?;
        }
        Ok(())
    }
}
