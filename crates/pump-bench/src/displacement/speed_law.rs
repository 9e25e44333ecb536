//! A speed law with the range of speeds in which it holds.

use pump_model::math::{rad_s, rpm};
use pump_model::{ModelError, Pump, SpeedLaw, SpeedLawFlow};
use thiserror::Error;

/// Largest relative rounding between a speed in r/min and the speed in rad/s.
const ROUNDING: f64 = 1e-9;

/// A law of volume against speed that holds between two speeds, forward and in reverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangedLaw {
    /// Law of volume against speed.
    pub law: SpeedLaw,
    /// Slowest speed at which the law holds, in r/min.
    pub least_rpm: f64,
    /// Fastest speed at which the law holds, in r/min.
    pub most_rpm: f64,
}

/// A speed or a flow beyond the pump file's speed law.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SpeedLawError {
    /// The law does not hold at the speed.
    #[error(
        "the pump file's speed law holds from {least_rpm} to {most_rpm} r/min, and {asked} is beyond; ask \
         for a speed within, or change least_rpm or most_rpm of its [speed_law] if it holds there, or write \
         kind = \"none\""
    )]
    OutsideSpeeds {
        /// Speed that was asked for, with its unit.
        asked: String,
        /// Slowest speed at which the law holds, in r/min.
        least_rpm: f64,
        /// Fastest speed at which the law holds, in r/min.
        most_rpm: f64,
    },
    /// The law gives the flow at no speed.
    #[error(
        "by the pump file's speed law the mean flow is {least_ml_s:.4} mL/s at {least_rpm:.4} r/min, its \
         slowest speed, and {most_ml_s:.4} mL/s at {at_rpm:.4} r/min at most, so {flow_ml_s} mL/s is beyond; \
         ask for a flow within"
    )]
    OutsideFlows {
        /// Flow that was asked for, in mL/s.
        flow_ml_s: f64,
        /// Flow at the slowest speed, in mL/s, rounded up.
        least_ml_s: f64,
        /// Slowest speed at which the law holds, in r/min.
        least_rpm: f64,
        /// Largest flow, in mL/s, rounded down.
        most_ml_s: f64,
        /// Speed of the largest flow, in r/min.
        at_rpm: f64,
    },
    /// The model refuses the law or the pump.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl RangedLaw {
    /// Returns true if the law holds at a speed in r/min, forward or in reverse.
    pub fn covers(&self, speed_rpm: f64) -> bool {
        let range = self.least_rpm * (1.0 - ROUNDING)..=self.most_rpm * (1.0 + ROUNDING);
        range.contains(&speed_rpm.abs())
    }

    /// Returns kappa(N) of `pump`, which is without the law, at a speed in rad/s. The speed is negative in
    /// reverse.
    ///
    /// # Errors
    /// [`SpeedLawError::OutsideSpeeds`] for a speed at which the law does not hold, or
    /// [`SpeedLawError::Model`].
    pub fn factor_at(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, SpeedLawError> {
        let speed_rpm = rpm(speed_rad_s);
        if !self.covers(speed_rpm) {
            let Self { least_rpm, most_rpm, .. } = *self;
            return Err(SpeedLawError::OutsideSpeeds {
                asked: format!("{speed_rpm:.4} r/min"),
                least_rpm,
                most_rpm,
            });
        }
        Ok(self.law.factor(pump, speed_rad_s)?)
    }

    /// Returns `pump` with every flow and volume at a speed in rad/s. The speed is negative in reverse.
    ///
    /// # Errors
    /// [`SpeedLawError::OutsideSpeeds`] for a speed at which the law does not hold, or
    /// [`SpeedLawError::Model`].
    pub fn pump_at(&self, pump: &Pump, speed_rad_s: f64) -> Result<Pump, SpeedLawError> {
        Ok(pump.scaled(self.factor_at(pump, speed_rad_s)?)?)
    }

    /// Returns the mean flow of `pump` in mL/s at a speed in rad/s. Both are negative in reverse.
    ///
    /// # Errors
    /// [`SpeedLawError::OutsideSpeeds`] for a speed at which the law does not hold, or
    /// [`SpeedLawError::Model`].
    pub fn average_flow_ml_s(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, SpeedLawError> {
        Ok(self.factor_at(pump, speed_rad_s)? * pump.average_flow_ml_s(speed_rad_s))
    }

    /// Returns the law up to `most_rpm`, in r/min. A law that holds at faster speeds alone is returned
    /// unchanged.
    #[must_use]
    pub fn up_to(self, most_rpm: f64) -> Self {
        if self.least_rpm <= most_rpm { Self { most_rpm: self.most_rpm.min(most_rpm), ..self } } else { self }
    }

    /// Returns the largest mean flow of `pump` in mL/s.
    ///
    /// # Errors
    /// [`SpeedLawError::Model`] if the model refuses the law or the pump.
    pub fn largest_ml_s(&self, pump: &Pump) -> Result<f64, SpeedLawError> {
        Ok(self.flow(pump, false)?.largest()?.0)
    }

    /// Returns the slowest speed in rad/s whose mean flow is `flow_ml_s`. Both are negative in reverse.
    ///
    /// # Errors
    /// [`SpeedLawError::OutsideFlows`] for a flow that the law gives at no speed, or
    /// [`SpeedLawError::Model`].
    pub fn speed_for_flow(&self, pump: &Pump, flow_ml_s: f64) -> Result<f64, SpeedLawError> {
        let flow = self.flow(pump, flow_ml_s < 0.0)?;
        match flow.speed_rad_s(flow_ml_s.abs())? {
            Some(speed_rad_s) => Ok(speed_rad_s.copysign(flow_ml_s)),
            None => Err(self.outside_flows(pump, flow_ml_s, flow_ml_s < 0.0)?),
        }
    }

    /// Returns the refusal of a flow that the law gives at no speed.
    pub(crate) fn outside_flows(
        &self,
        pump: &Pump,
        flow_ml_s: f64,
        reverse: bool,
    ) -> Result<SpeedLawError, ModelError> {
        let flow = self.flow(pump, reverse)?;
        let (most_ml_s, at_rad_s) = flow.largest()?;
        Ok(SpeedLawError::OutsideFlows {
            flow_ml_s,
            // Rounding inwards, so that the flows in the message can be reached.
            least_ml_s: (flow.at(rad_s(self.least_rpm))? * 1e4).ceil() / 1e4,
            least_rpm: self.least_rpm,
            most_ml_s: (most_ml_s * 1e4).floor() / 1e4,
            at_rpm: rpm(at_rad_s),
        })
    }

    /// Returns the mean flow against the speed.
    pub(crate) fn flow<'a>(&'a self, pump: &'a Pump, reverse: bool) -> Result<SpeedLawFlow<'a>, ModelError> {
        SpeedLawFlow::new(&self.law, pump, [rad_s(self.least_rpm), rad_s(self.most_rpm)], reverse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law() -> (RangedLaw, Pump) {
        (RangedLaw { law: SpeedLaw::PUBLISHED, least_rpm: 10.0, most_rpm: 170.0 }, Pump::three_roller())
    }

    #[test]
    fn a_flow_gives_a_speed_and_the_speed_that_flow() {
        let (law, pump) = law();
        for flow_ml_s in [4.0, 5.0, 20.0, 35.0, 59.0, -5.0, -40.0] {
            let speed_rad_s = law.speed_for_flow(&pump, flow_ml_s).unwrap();
            let back_ml_s = law.average_flow_ml_s(&pump, speed_rad_s).unwrap();
            assert!((back_ml_s - flow_ml_s).abs() < 1e-9, "{flow_ml_s} {back_ml_s}");
            let at = law.pump_at(&pump, speed_rad_s).unwrap();
            assert!((at.average_flow_ml_s(speed_rad_s) - flow_ml_s).abs() < 1e-9);
        }
    }

    #[test]
    fn what_the_law_does_not_say_is_refused_with_what_it_says() {
        let (law, pump) = law();
        for speed_rpm in [9.9, 170.1, -171.0] {
            let error = law.factor_at(&pump, rad_s(speed_rpm)).unwrap_err().to_string();
            assert!(error.contains("from 10 to 170 r/min"), "{error}");
        }
        assert!(law.factor_at(&pump, rad_s(170.0)).is_ok() && law.factor_at(&pump, rad_s(10.0)).is_ok());
        for asked_ml_s in [70.0, 1.0, -70.0] {
            let SpeedLawError::OutsideFlows { least_ml_s, most_ml_s, .. } =
                law.speed_for_flow(&pump, asked_ml_s).unwrap_err()
            else {
                panic!("another error")
            };
            for flow_ml_s in [least_ml_s, most_ml_s] {
                assert!(law.speed_for_flow(&pump, flow_ml_s).is_ok(), "{flow_ml_s} is offered");
            }
            assert!(law.speed_for_flow(&pump, most_ml_s + 2e-4).is_err());
        }
    }

    #[test]
    fn the_steady_state_is_that_of_the_volume_at_its_speed() {
        let (law, pump) = law();
        for speed_rpm in [20.0, 90.0, 165.0] {
            let speed_rad_s = rad_s(speed_rpm);
            let (plain, with) = (
                pump.steady_state(speed_rad_s).unwrap(),
                law.pump_at(&pump, speed_rad_s).unwrap().steady_state(speed_rad_s).unwrap(),
            );
            let kappa = law.factor_at(&pump, speed_rad_s).unwrap();
            let rest_kpa = pump.outlet().reservoir_kpa;
            for (one, other) in [
                (plain.mean_flow_ml_s, with.mean_flow_ml_s),
                (plain.outlet.max_kpa - rest_kpa, with.outlet.max_kpa - rest_kpa),
                (plain.inlet.min_kpa - rest_kpa, with.inlet.min_kpa - rest_kpa),
            ] {
                // The model is linear in the flow.
                assert!((kappa * one - other).abs() < 1e-6, "{speed_rpm}: {one} {other}");
            }
            assert!((kappa - 1.0).abs() > 1e-3, "{kappa}");
        }
    }
}
