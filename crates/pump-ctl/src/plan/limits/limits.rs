//! The limits of a dose.

use super::motor::Motor;
use super::pressure_limits::{Lowest, PressureLimits};
use super::torque::Torque;
use crate::plan::words::{PlanError, SetBy};

/// Limits of the motor and, where given, of the pressures and the torque.
///
/// ```
/// use pump_ctl::plan::{Limits, Lowest, Motor, PressureLimits, SetBy};
///
/// let motor = Motor::new(12_800.0, 17.8, 500.0);
/// let pressures = PressureLimits { min_inlet_kpa: Some(60.0), ..PressureLimits::NONE };
/// let collapse = Lowest { kpa: 43.05, set_by: SetBy::TubeCollapse };
/// let limits = Limits::new(motor).with_pressures(pressures).with_lowest(collapse);
/// limits.validate()?;
/// assert_eq!(limits.lowest_where_it_sucks(), Some(Lowest { kpa: 60.0, set_by: SetBy::Given }));
/// # Ok::<(), pump_ctl::plan::PlanError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Limits {
    /// Steps, speed and acceleration of the motor.
    pub motor: Motor,
    /// Pressures that the user has set as limits.
    pub pressures: PressureLimits,
    /// Smallest pressure that tube and fluid stand, at either port. It holds at the discharge too, since the
    /// flow in a long line runs on when the rotor stops. `None` is not checked.
    pub lowest: Option<Lowest>,
    /// Torque that turning takes, and torque that the motor has. `None` is not checked.
    pub torque: Option<Torque>,
}

impl Limits {
    /// Makes limits of the motor alone.
    pub const fn new(motor: Motor) -> Self {
        Self { motor, pressures: PressureLimits::NONE, lowest: None, torque: None }
    }

    /// Returns the limits with pressures that the user has set.
    #[must_use]
    pub const fn with_pressures(self, pressures: PressureLimits) -> Self {
        Self { pressures, ..self }
    }

    /// Returns the limits with the smallest pressure that tube and fluid stand.
    #[must_use]
    pub const fn with_lowest(self, lowest: Lowest) -> Self {
        Self { lowest: Some(lowest), ..self }
    }

    /// Returns the limits with the torque that turning takes, and that the motor has.
    #[must_use]
    pub const fn with_torque(self, torque: Torque) -> Self {
        Self { torque: Some(torque), ..self }
    }

    /// Returns the smallest pressure that is allowed at the suction port. It is the larger of the given limit
    /// and the pressure that tube and fluid stand.
    pub fn lowest_where_it_sucks(&self) -> Option<Lowest> {
        let given = self.pressures.min_inlet_kpa.map(|kpa| Lowest { kpa, set_by: SetBy::Given });
        given.into_iter().chain(self.lowest).max_by(|a, b| a.kpa.total_cmp(&b.kpa))
    }

    /// Returns true if a pressure or the torque is limited, so that a dose must be predicted.
    pub(in crate::plan) fn are_predicted(&self) -> bool {
        self.pressures.max_outlet_kpa.is_some()
            || self.lowest_where_it_sucks().is_some()
            || self.torque.is_some()
    }

    /// Refuses limits outside their ranges.
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
