//! What is asked of a dose.

use super::{Finish, PlanError};

/// Largest dose, mL: 100 L are five hours at the default rate of the published pump.
pub const MAX_VOLUME_ML: f64 = 1e5;

/// How fast to dose.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Cruise {
    /// Mean flow at the cruise speed, mL/s, positive.
    Flow {
        /// mL/s.
        ml_s: f64,
    },
    /// Cruise speed of the pump head, rad/s, positive.
    Speed {
        /// rad/s.
        rad_s: f64,
    },
    /// Total time with ramps and settling, s, positive: the slowest cruise that meets it.
    Within {
        /// s.
        time_s: f64,
    },
    /// The fastest that holds every limit, of those below which every speed does.
    Fastest,
}

/// A dose to plan.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Request {
    /// Volume, mL; negative in reverse; not zero.
    pub volume_ml: f64,
    /// What earlier doses owe, mL, positive toward the outlet.
    pub carry_in_ml: f64,
    /// How fast.
    pub cruise: Cruise,
    /// Whether the speed follows the rollers' angle so that the flow at the outlet is as smooth as the motor allows.
    /// Flow and speed of `cruise` are then means over whole pitches.
    pub smooth: bool,
    /// Where in a pitch it may end.
    pub finish: Finish,
}

impl Request {
    /// A dose at constant speed with nothing owed.
    pub fn new(volume_ml: f64, cruise: Cruise) -> Self {
        Self { volume_ml, carry_in_ml: 0.0, cruise, smooth: false, finish: Finish::Any }
    }

    /// The same with a smooth flow.
    pub fn smooth(self) -> Self {
        Self { smooth: true, ..self }
    }

    /// The same, ending where the flow is low.
    pub fn low_flow(self) -> Self {
        Self { finish: Finish::LowFlow, ..self }
    }

    /// Volume to bring to the vessel: requested plus owed, mL.
    pub(super) fn owed_ml(&self) -> f64 {
        self.volume_ml + self.carry_in_ml
    }

    pub(super) fn validate(&self) -> Result<(), PlanError> {
        if !(self.volume_ml != 0.0 && self.volume_ml.abs() <= MAX_VOLUME_ML) {
            return Err(PlanError::OutOfRange {
                parameter: "volume in mL",
                value: self.volume_ml,
                allowed: "up to 100000 either way, not zero",
            });
        }
        if self.carry_in_ml.is_nan() || self.carry_in_ml.abs() > MAX_VOLUME_ML {
            return Err(PlanError::OutOfRange {
                parameter: "carry of earlier doses in mL",
                value: self.carry_in_ml,
                allowed: "up to 100000 either way",
            });
        }
        let (parameter, value) = match self.cruise {
            Cruise::Flow { ml_s } => ("rate in mL/s", ml_s),
            Cruise::Speed { rad_s } => ("speed in rad/s", rad_s),
            Cruise::Within { time_s } => ("time in s", time_s),
            Cruise::Fastest => return Ok(()),
        };
        if value.is_finite() && value > 0.0 {
            Ok(())
        } else {
            Err(PlanError::OutOfRange { parameter, value, allowed: "a positive number" })
        }
    }
}
