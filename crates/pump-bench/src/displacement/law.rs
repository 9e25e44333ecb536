//! The law by which the displacement of a pump depends on its speed, with the speeds at which it holds.

use std::fmt;

use pump_model::units::{degrees, rad_s, rpm};
use pump_model::{ModelError, Pump, SpeedLaw, SpeedLawFlow};

use super::error::DisplacementError;

/// Largest relative rounding between a speed in r/min and the speed in rad/s.
const ROUNDING: f64 = 1e-9;

/// A law of volume against speed that holds between two speeds, forward and in reverse.
///
/// The law is the experimental [`SpeedLaw`]. Its `Display` names the law and its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementLaw {
    law: SpeedLaw,
    least_rpm: f64,
    most_rpm: f64,
}

impl DisplacementLaw {
    /// Returns `law` as it holds from `least_rpm` to `most_rpm`, in r/min.
    pub(crate) fn new(law: SpeedLaw, [least_rpm, most_rpm]: [f64; 2]) -> Self {
        Self { law, least_rpm, most_rpm }
    }

    /// Returns the slowest and the fastest speed at which the law holds, in r/min.
    pub(crate) fn range_rpm(&self) -> (f64, f64) {
        (self.least_rpm, self.most_rpm)
    }

    /// Returns true if the law holds at a speed in r/min, forward or in reverse.
    pub(crate) fn covers(&self, speed_rpm: f64) -> bool {
        let range = self.least_rpm * (1.0 - ROUNDING)..=self.most_rpm * (1.0 + ROUNDING);
        range.contains(&speed_rpm.abs())
    }

    /// Returns kappa(N) of `pump`, which is without the law, at a speed in rad/s. The speed is negative in
    /// reverse.
    ///
    /// # Errors
    ///
    /// [`DisplacementError::OutsideSpeeds`] for a speed at which the law does not hold, or
    /// [`DisplacementError::Model`].
    pub(crate) fn factor_at(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, DisplacementError> {
        let speed_rpm = rpm(speed_rad_s);
        if !self.covers(speed_rpm) {
            let Self { least_rpm, most_rpm, .. } = *self;
            let asked = format!("{speed_rpm:.4} r/min");
            return Err(DisplacementError::OutsideSpeeds { asked, least_rpm, most_rpm });
        }
        Ok(self.factor_at_any(pump, speed_rad_s)?)
    }

    /// Returns kappa(N) of `pump` at a speed in rad/s, even if the law does not hold there. Searches pass
    /// through such speeds.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if the model refuses the law, the pump or the speed.
    pub(crate) fn factor_at_any(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, ModelError> {
        self.law.factor(pump, speed_rad_s)
    }

    /// Returns the law up to `most_rpm`, in r/min. A law that holds at faster speeds alone is returned
    /// unchanged.
    #[must_use]
    pub(crate) fn up_to(self, most_rpm: f64) -> Self {
        if self.least_rpm <= most_rpm { Self { most_rpm: self.most_rpm.min(most_rpm), ..self } } else { self }
    }

    /// Returns the largest mean flow of `pump`, in mL/s, positive.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if the model refuses the law or the pump.
    pub(crate) fn largest_flow_ml_s(&self, pump: &Pump, reverse: bool) -> Result<f64, ModelError> {
        Ok(self.flow(pump, reverse)?.largest()?.0)
    }

    /// Returns the slowest speed in rad/s, positive, whose mean flow is `flow_ml_s`, positive. Returns `None`
    /// if the law gives that flow at no speed.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if the model refuses the law or the pump.
    pub(crate) fn speed_for_flow(
        &self,
        pump: &Pump,
        flow_ml_s: f64,
        reverse: bool,
    ) -> Result<Option<f64>, ModelError> {
        self.flow(pump, reverse)?.speed_rad_s(flow_ml_s)
    }

    /// Returns the refusal of a flow that the law gives at no speed.
    pub(crate) fn outside_flows(
        &self,
        pump: &Pump,
        flow_ml_s: f64,
        reverse: bool,
    ) -> Result<DisplacementError, ModelError> {
        let flow = self.flow(pump, reverse)?;
        let (most_ml_s, at_rad_s) = flow.largest()?;
        Ok(DisplacementError::OutsideFlows {
            flow_ml_s,
            // Rounding inwards, so that the flows in the message can be reached.
            least_ml_s: (flow.at(rad_s(self.least_rpm))? * 1e4).ceil() / 1e4,
            least_rpm: self.least_rpm,
            most_ml_s: (most_ml_s * 1e4).floor() / 1e4,
            at_rpm: rpm(at_rad_s),
        })
    }

    /// Returns the mean flow against the speed.
    fn flow<'a>(&'a self, pump: &'a Pump, reverse: bool) -> Result<SpeedLawFlow<'a>, ModelError> {
        SpeedLawFlow::new(&self.law, pump, [rad_s(self.least_rpm), rad_s(self.most_rpm)], reverse)
    }
}

impl fmt::Display for DisplacementLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SpeedLaw { scale, distensibility_per_kpa, closure_rad, .. } = self.law;
        let closure_deg = degrees(closure_rad);
        write!(f, "inlet-pressure, s {scale}, D {distensibility_per_kpa:e} /kPa, closed at {closure_deg:.2}°")
    }
}
