//! A pump whose displacement may depend on its speed.

use pump_model::units::rad_s;
use pump_model::{ModelError, Pump};

use super::error::DisplacementError;
use super::law::DisplacementLaw;

/// A pump with the law of its displacement, if it has one. Without a law every speed has the same volume.
///
/// ```
/// use pump_model::units::rad_s;
/// let pump = pump_bench::built_in("three-roller").unwrap().speed_dependent_pump()?;
/// let speed_rad_s = pump.speed_for_flow(20.0)?;
/// assert!((pump.at(speed_rad_s)?.average_flow_ml_s(speed_rad_s) - 20.0).abs() < 1e-9);
/// # Ok::<(), pump_bench::displacement::DisplacementError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedDependentPump {
    base: Pump,
    law: Option<DisplacementLaw>,
}

impl SpeedDependentPump {
    /// Returns the pump `base`, as it is without the law, with the law.
    pub fn new(base: Pump, law: Option<DisplacementLaw>) -> Self {
        Self { base, law }
    }

    /// Returns the pump `base` with the same volume at every speed.
    pub(crate) fn constant(base: Pump) -> Self {
        Self::new(base, None)
    }

    /// Returns the pump as it is without the law.
    pub fn base(&self) -> &Pump {
        &self.base
    }

    /// Returns the law of the displacement, or `None` if every speed has the same volume.
    pub fn law(&self) -> Option<&DisplacementLaw> {
        self.law.as_ref()
    }

    /// Returns the pump if every speed has the same volume.
    ///
    /// # Errors
    ///
    /// [`DisplacementError::NotConstant`] if the volume depends on the speed.
    pub(crate) fn into_constant(self) -> Result<Pump, DisplacementError> {
        if self.law.is_none() { Ok(self.base) } else { Err(DisplacementError::NotConstant) }
    }

    /// Returns the pump with its law up to `most_rpm`, in r/min. A law that holds at faster speeds alone stays
    /// unchanged.
    #[must_use]
    pub(crate) fn up_to(self, most_rpm: f64) -> Self {
        Self { law: self.law.map(|law| law.up_to(most_rpm)), ..self }
    }

    /// Returns the pump with every flow and volume at a speed in rad/s. The speed is negative in reverse.
    ///
    /// # Errors
    ///
    /// [`DisplacementError::OutsideSpeeds`] for a speed at which the law does not hold, or
    /// [`DisplacementError::Model`].
    pub fn at(&self, speed_rad_s: f64) -> Result<Pump, DisplacementError> {
        match &self.law {
            None => Ok(self.base),
            Some(law) => Ok(self.base.scaled(law.factor_at(&self.base, speed_rad_s)?)?),
        }
    }

    /// Returns the mean flow in mL/s at a speed in rad/s. Both are negative in reverse.
    ///
    /// # Errors
    ///
    /// [`DisplacementError::OutsideSpeeds`] for a speed at which the law does not hold, or
    /// [`DisplacementError::Model`].
    pub fn average_flow_ml_s(&self, speed_rad_s: f64) -> Result<f64, DisplacementError> {
        let base_ml_s = self.base.average_flow_ml_s(speed_rad_s);
        match &self.law {
            None => Ok(base_ml_s),
            Some(law) => Ok(law.factor_at(&self.base, speed_rad_s)? * base_ml_s),
        }
    }

    /// Returns the largest mean flow in mL/s up to `most_rpm`, in r/min.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if the model refuses the law or the pump.
    pub(crate) fn largest_flow_ml_s(&self, most_rpm: f64) -> Result<f64, ModelError> {
        match &self.law {
            None => Ok(self.base.average_flow_ml_s(rad_s(most_rpm))),
            Some(law) => law.up_to(most_rpm).largest_flow_ml_s(&self.base, false),
        }
    }

    /// Returns the slowest speed in rad/s whose mean flow over whole pitches is `flow_ml_s`. Both are negative
    /// in reverse.
    ///
    /// # Errors
    ///
    /// [`DisplacementError::OutsideFlows`] for a flow that the law gives at no speed, or
    /// [`DisplacementError::Model`].
    pub fn speed_for_flow(&self, flow_ml_s: f64) -> Result<f64, DisplacementError> {
        let Some(law) = &self.law else {
            return Ok(pump_ctl::plan::speed_for_flow(&self.base, flow_ml_s));
        };
        let reverse = flow_ml_s < 0.0;
        match law.speed_for_flow(&self.base, flow_ml_s.abs(), reverse)? {
            Some(speed_rad_s) => Ok(speed_rad_s.copysign(flow_ml_s)),
            None => Err(law.outside_flows(&self.base, flow_ml_s, reverse)?),
        }
    }
}
