//! The speeds that a calibration or law covers, and refusals of others.

use pump_ctl::plan::Request;
use pump_model::ModelError;
use pump_model::units::rad_s;

use super::{Planner, reverse};
use crate::calibration::{AgainstSpeed, CalibrationError};
use crate::displacement::DisplacementError;
use crate::dosing::DoseError;

impl Planner<'_> {
    /// Refuses a speed in r/min that calibration or law do not cover. The plan refuses a speed beyond the
    /// motor.
    ///
    /// # Errors
    ///
    /// A refusal that names the speeds that are covered.
    pub(super) fn covers(
        &self,
        against: &AgainstSpeed<'_>,
        speed_rpm: f64,
        request: &Request,
        asked: impl Fn() -> String,
    ) -> Result<(), DoseError> {
        let beyond_motor = rad_s(speed_rpm) > self.limits.motor.max_speed_rad_s * (1.0 + 1e-12);
        if against.covers(speed_rpm) || beyond_motor {
            return Ok(());
        }
        Err(self
            .outside(against, asked(), request)
            .unwrap_or_else(|error| CalibrationError::from(error).into()))
    }

    /// Returns the refusal of a flow that no speed gives.
    pub(super) fn outside_flows(
        &self,
        against: &AgainstSpeed<'_>,
        ml_s: f64,
        request: &Request,
    ) -> DoseError {
        let found = match against.given_law() {
            Some(law) => law.outside_flows(self.pump.base(), ml_s, reverse(request)).map(DoseError::from),
            None => self.outside(against, format!("{ml_s} mL/s"), request),
        };
        found.unwrap_or_else(|error| CalibrationError::from(error).into())
    }

    /// Returns the refusal of a speed or flow, named in words by `asked`, outside of the calibration or law.
    fn outside(
        &self,
        against: &AgainstSpeed<'_>,
        asked: String,
        request: &Request,
    ) -> Result<DoseError, ModelError> {
        let (least_rpm, most_rpm) = against.range_rpm().unwrap_or((0.0, f64::INFINITY));
        let Some(stored) = self.stored.filter(|_| against.displacement().is_some()) else {
            return Ok(DisplacementError::OutsideSpeeds { asked, least_rpm, most_rpm }.into());
        };
        let (least_ml_s, most_ml_s) = against.flows_ml_s(reverse(request))?.unwrap_or((0.0, f64::INFINITY));
        let version = stored.version;
        let outside =
            CalibrationError::OutsideSpeeds { version, least_rpm, most_rpm, least_ml_s, most_ml_s, asked };
        Ok(outside.into())
    }
}
