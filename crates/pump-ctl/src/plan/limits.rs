//! What a dose must not exceed.

use core::fmt;

use pump_model::math::TURN_RAD;

use super::PlanError;
use super::torque::Torque;

/// The stepper motor, as seen at the pump head.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Motor {
    /// Steps per revolution of the pump head, gear included.
    pub steps_per_rev: f64,
    /// Fastest speed of the pump head, rad/s.
    pub max_speed_rad_s: f64,
    /// Largest acceleration of the pump head, rad/s².
    pub max_acceleration_rad_s2: f64,
}

impl Motor {
    /// Angle of a step, rad.
    pub fn step_rad(&self) -> f64 {
        TURN_RAD / self.steps_per_rev
    }
}

/// What sets the smallest pressure at a port, for messages and reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SetBy {
    /// Somebody's figure.
    Given,
    /// Where the tube would collapse.
    TubeCollapse,
    /// The fluid's vapour pressure.
    Vapour,
}

impl fmt::Display for SetBy {
    /// What is said behind the pressure: nothing of a figure that was given.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(match self {
            Self::Given => "",
            Self::TubeCollapse => ", at which the tube would collapse (thin-wall estimate)",
            Self::Vapour => ", the fluid's vapour pressure",
        })
    }
}

/// The smallest pressure that is allowed at a port.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Lowest {
    /// kPa absolute.
    pub kpa: f64,
    /// What sets it.
    pub set_by: SetBy,
}

/// Limits of the motor and, where given, of the pressures and the torque.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Limits {
    /// Steps, speed and acceleration.
    pub motor: Motor,
    /// Largest pressure at the port that pushes, kPa absolute; none is not checked.
    pub max_outlet_kpa: Option<f64>,
    /// Smallest pressure at the port that sucks, kPa absolute; none is not checked.
    pub min_inlet_kpa: Option<f64>,
    /// Smallest pressure that tube and fluid stand, at either port: a long outlet line runs on when the rotor stops. None is not
    /// checked.
    pub lowest: Option<Lowest>,
    /// What turning takes and what the motor can give; none is not checked.
    pub torque: Option<Torque>,
}

impl Limits {
    /// The motor alone.
    pub const fn of_motor(motor: Motor) -> Self {
        Self { motor, max_outlet_kpa: None, min_inlet_kpa: None, lowest: None, torque: None }
    }

    /// The smallest pressure that is allowed at the port that sucks: the larger of what was given and what tube and fluid stand.
    pub fn lowest_where_it_sucks(&self) -> Option<Lowest> {
        let given = self.min_inlet_kpa.map(|kpa| Lowest { kpa, set_by: SetBy::Given });
        given.into_iter().chain(self.lowest).max_by(|a, b| a.kpa.total_cmp(&b.kpa))
    }

    /// Refuses limits that mean nothing.
    pub fn validate(&self) -> Result<(), PlanError> {
        let within = |parameter, value: f64, range: core::ops::RangeInclusive<f64>, allowed| {
            if range.contains(&value) {
                Ok(())
            } else {
                Err(PlanError::OutOfRange { parameter, value, allowed })
            }
        };
        within("steps per revolution", self.motor.steps_per_rev, 4.0..=1e9, "4 to 1e9")?;
        within("largest speed in rad/s", self.motor.max_speed_rad_s, 1e-9..=1e4, "1e-9 to 1e4")?;
        within(
            "largest acceleration in rad/s2",
            self.motor.max_acceleration_rad_s2,
            1e-6..=1e7,
            "1e-6 to 1e7",
        )?;
        if let Some(limit) = self.max_outlet_kpa {
            within(
                "outlet pressure limit in kPa absolute",
                limit,
                1e-9..=1e6,
                "a positive pressure, 1e6 at most",
            )?;
        }
        if let Some(limit) = self.min_inlet_kpa {
            within("inlet pressure limit in kPa absolute", limit, -1e6..=1e6, "within 1e6 either way")?;
        }
        if let Some(lowest) = self.lowest {
            within("smallest pressure in kPa absolute", lowest.kpa, -1e6..=1e6, "within 1e6 either way")?;
        }
        if let Some(torque) = &self.torque {
            torque.validate()?;
        }
        Ok(())
    }
}
