//! Refusal of pump files whose contents contradict one another or cannot work.

use pump_model::Pump;

use crate::displacement::SpeedLawError;

use super::error::PumpFileError;
use super::file::{PumpFile, SCHEMA};
use super::range::{WrongValue, allow};

impl PumpFile {
    /// Refuses contents that contradict one another or cannot work. `origin` names the file in errors.
    ///
    /// # Errors
    /// [`PumpFileError::Schema`] or [`PumpFileError::Value`] for a schema or a value that is not allowed.
    /// [`PumpFileError::Limits`], [`PumpFileError::Model`] or [`PumpFileError::SpeedLaw`] for a pump that
    /// cannot work.
    pub fn check(&self, origin: &str) -> Result<(), PumpFileError> {
        if self.schema != SCHEMA {
            return Err(PumpFileError::Schema { origin: origin.to_owned(), schema: self.schema.clone() });
        }
        self.check_tables().map_err(|wrong| wrong.in_file(origin))?;
        self.check_pump(origin)
    }

    /// Refuses the first value that is wrong by itself or beside others.
    fn check_tables(&self) -> Result<(), WrongValue> {
        self.pump.check()?;
        self.tube.check()?;
        self.motor.check()?;
        self.speed_law.check()?;
        self.drive.as_ref().map_or(Ok(()), |drive| drive.check())?;
        let has_hose = self.inlet.is_estimated() || self.outlet.is_estimated();
        self.fluid.check(has_hose)?;
        self.ambient.check()?;
        self.uncertainty.check()
    }

    /// Refuses limits, a model, a speed law or a default rate that cannot work.
    fn check_pump(&self, origin: &str) -> Result<(), PumpFileError> {
        let named = || origin.to_owned();
        let limits = self.limits();
        limits.validate().map_err(|source| PumpFileError::Limits { origin: named(), source })?;
        let model = self.model().map_err(|source| PumpFileError::Model { origin: named(), source })?;
        let rate = self.pump.default_rate_ml_s;
        self.check_speed_law(&model, rate, origin)?;
        let fastest = model.average_flow_ml_s(limits.motor.max_speed_rad_s);
        allow(
            rate > 0.0 && rate <= fastest,
            "[pump] default_rate_ml_s",
            rate,
            "more than 0, and no more than the flow at [motor] max_speed_rpm",
        )
        .map_err(|wrong| wrong.in_file(origin))
    }

    /// Refuses a speed law that cannot be computed or has no speed for the default rate.
    fn check_speed_law(&self, model: &Pump, rate_ml_s: f64, origin: &str) -> Result<(), PumpFileError> {
        let of_model = |source| PumpFileError::Model { origin: origin.to_owned(), source };
        let Some(law) = self.speed_law().map_err(of_model)? else { return Ok(()) };
        match law.up_to(self.motor.max_speed_rpm).speed_for_flow(model, rate_ml_s) {
            Ok(_) => Ok(()),
            Err(SpeedLawError::Model(source)) => Err(of_model(source)),
            Err(source) => Err(PumpFileError::SpeedLaw { origin: origin.to_owned(), source }),
        }
    }
}
