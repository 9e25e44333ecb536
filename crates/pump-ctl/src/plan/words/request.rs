//! The request for a dose.

use pump_model::Allowed;

use super::cruise::Cruise;
use crate::parameter::Parameter;

use super::error::{PlanError, within};
use super::finish::Finish;
use super::ramps::Ramps;
use super::turned::Turned;

/// Largest dose, mL. Its 100 L take five hours at the default rate of the published pump.
pub const MAX_VOLUME_ML: f64 = 1e5;

/// A dose to plan.
///
/// ```
/// use pump_ctl::plan::{Cruise, Finish, Request};
///
/// let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 })
///     .with_smooth(true)
///     .with_finish(Finish::LowFlow)
///     // The carry of earlier doses adds to the volume.
///     .with_carry_in_ml(-0.02);
/// assert_eq!((request.smooth, request.finish), (true, Finish::LowFlow));
/// assert_eq!((request.volume_ml, request.carry_in_ml), (25.0, -0.02));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
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
    /// Turn of the earlier doses whose sum with this dose is to be right. `None` plans this dose alone.
    pub turned: Option<Turned>,
    /// Ramps in which the dose starts and stops. A request that was stored without them has the default.
    #[cfg_attr(feature = "serde", serde(default))]
    pub ramps: Ramps,
}

impl Request {
    /// Makes a request for a dose at constant speed, with no carry, an end anywhere and line-aware ramps.
    pub const fn new(volume_ml: f64, cruise: Cruise) -> Self {
        Self {
            volume_ml,
            carry_in_ml: 0.0,
            cruise,
            smooth: false,
            finish: Finish::Any,
            turned: None,
            ramps: Ramps::LineAware,
        }
    }

    /// Returns the request with a carry of earlier doses, mL, positive toward the outlet.
    #[must_use]
    pub const fn with_carry_in_ml(self, carry_in_ml: f64) -> Self {
        Self { carry_in_ml, ..self }
    }

    /// Returns the request with another speed.
    #[must_use]
    pub const fn with_cruise(self, cruise: Cruise) -> Self {
        Self { cruise, ..self }
    }

    /// Returns the request with a smooth flow, or with constant speed.
    #[must_use]
    pub const fn with_smooth(self, smooth: bool) -> Self {
        Self { smooth, ..self }
    }

    /// Returns the request with the place in a pitch at which the dose may end.
    #[must_use]
    pub const fn with_finish(self, finish: Finish) -> Self {
        Self { finish, ..self }
    }

    /// Returns the request with the turn of the earlier doses whose sum with this dose is to be right, or
    /// `None` for this dose alone.
    #[must_use]
    pub const fn with_turned(self, turned: Option<Turned>) -> Self {
        Self { turned, ..self }
    }

    /// Returns the request with other ramps.
    #[must_use]
    pub const fn with_ramps(self, ramps: Ramps) -> Self {
        Self { ramps, ..self }
    }

    /// Returns the volume to bring to the vessel, requested plus carried, mL.
    pub(in crate::plan) fn owed_ml(&self) -> f64 {
        self.volume_ml + self.carry_in_ml
    }

    pub(in crate::plan) fn validate(&self) -> Result<(), PlanError> {
        within(Parameter::Volume, self.volume_ml, Allowed::EitherWayNotZero { most: MAX_VOLUME_ML })?;
        within(Parameter::Carry, self.carry_in_ml, Allowed::EitherWay { most: MAX_VOLUME_ML })?;
        self.turned.map_or(Ok(()), |turned| turned.validate())?;
        let (parameter, value) = match self.cruise {
            Cruise::Flow { ml_s } => (Parameter::Rate, ml_s),
            Cruise::Speed { rad_s } => (Parameter::Speed, rad_s),
            Cruise::Within { time_s } => (Parameter::Time, time_s),
            Cruise::Fastest => return Ok(()),
        };
        within(parameter, value, Allowed::Positive)
    }
}
