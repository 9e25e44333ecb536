//! The request for a dose.

use pump_model::Allowed;

use super::cruise::Cruise;
use super::error::{PlanError, within};
use super::finish::Finish;

/// Largest dose, mL. Its 100 L take five hours at the default rate of the published pump.
const MAX_VOLUME_ML: f64 = 1e5;

/// A dose to plan.
///
/// ```
/// use pump_ctl::plan::{Cruise, Finish, Request};
///
/// let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 }).smooth().low_flow();
/// assert_eq!((request.smooth, request.finish), (true, Finish::LowFlow));
/// // The carry of earlier doses adds to the volume.
/// let request = Request { carry_in_ml: -0.02, ..request };
/// assert_eq!(request.volume_ml, 25.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Request {
    /// Volume asked for, mL. Negative in reverse, and not zero.
    pub volume_ml: f64,
    /// Carry of earlier doses, mL, positive toward the outlet.
    pub carry_in_ml: f64,
    /// Speed of the dose.
    pub cruise: Cruise,
    /// True if the speed follows the rollers' angle, so that the flow at the outlet is as smooth as the motor
    /// allows. Flow and speed of `cruise` are then means over whole pitches.
    pub smooth: bool,
    /// Place in a pitch at which the dose may end.
    pub finish: Finish,
}

impl Request {
    /// Makes a request for a dose at constant speed, with no carry and an end anywhere.
    pub fn new(volume_ml: f64, cruise: Cruise) -> Self {
        Self { volume_ml, carry_in_ml: 0.0, cruise, smooth: false, finish: Finish::Any }
    }

    /// Returns the request with a smooth flow.
    #[must_use]
    pub fn smooth(self) -> Self {
        Self { smooth: true, ..self }
    }

    /// Returns the request with an end at low flow.
    #[must_use]
    pub fn low_flow(self) -> Self {
        Self { finish: Finish::LowFlow, ..self }
    }

    /// Returns the volume to bring to the vessel, requested plus carried, mL.
    pub(in crate::plan) fn owed_ml(&self) -> f64 {
        self.volume_ml + self.carry_in_ml
    }

    pub(in crate::plan) fn validate(&self) -> Result<(), PlanError> {
        within("volume in mL", self.volume_ml, Allowed::EitherWayNotZero { most: MAX_VOLUME_ML })?;
        within("carry of earlier doses in mL", self.carry_in_ml, Allowed::EitherWay { most: MAX_VOLUME_ML })?;
        let (parameter, value) = match self.cruise {
            Cruise::Flow { ml_s } => ("rate in mL/s", ml_s),
            Cruise::Speed { rad_s } => ("speed in rad/s", rad_s),
            Cruise::Within { time_s } => ("time in s", time_s),
            Cruise::Fastest => return Ok(()),
        };
        within(parameter, value, Allowed::Positive)
    }
}
