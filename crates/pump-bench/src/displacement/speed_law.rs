//! A speed law with the speeds for which it holds.

use pump_model::math::{rad_s, rpm};
use pump_model::{ModelError, Pump, SpeedLaw, SpeedLawFlow};
use thiserror::Error;

/// A speed in r/min may differ by so much of it from the same in rad/s.
const ROUNDING: f64 = 1e-9;

/// Volume against speed by a law that holds between two speeds, either way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangedLaw {
    /// The law.
    pub law: SpeedLaw,
    /// Slowest speed, r/min.
    pub least_rpm: f64,
    /// Fastest speed, r/min.
    pub most_rpm: f64,
}

/// What the pump file's speed law does not say.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SpeedLawError {
    /// A speed for which it does not hold.
    #[error(
        "the pump file's speed law holds from {least_rpm} to {most_rpm} r/min, and {asked} is beyond; ask for a speed \
         within, or change least_rpm or most_rpm of its [speed_law] if it holds there, or write kind = \"none\""
    )]
    OutsideSpeeds {
        /// What was asked.
        asked: String,
        /// Slowest, r/min.
        least_rpm: f64,
        /// Fastest, r/min.
        most_rpm: f64,
    },
    /// A flow that it gives at no speed.
    #[error(
        "by the pump file's speed law the mean flow is {least_ml_s:.4} mL/s at {least_rpm:.4} r/min, its slowest speed, and \
         {most_ml_s:.4} mL/s at {at_rpm:.4} r/min at most, so {flow_ml_s} mL/s is beyond; ask for a flow within"
    )]
    OutsideFlows {
        /// What was asked, mL/s.
        flow_ml_s: f64,
        /// Flow at the slowest speed, mL/s, rounded up.
        least_ml_s: f64,
        /// That speed, r/min.
        least_rpm: f64,
        /// Largest flow, mL/s, rounded down.
        most_ml_s: f64,
        /// Speed that has it, r/min.
        at_rpm: f64,
    },
    /// The law or the pump cannot be computed.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl RangedLaw {
    /// Whether it holds at a speed, r/min, either way.
    pub fn covers(&self, speed_rpm: f64) -> bool {
        let range = self.least_rpm * (1.0 - ROUNDING)..=self.most_rpm * (1.0 + ROUNDING);
        range.contains(&speed_rpm.abs())
    }

    /// kappa(N) of `pump`, as it is without law, at a speed in rad/s; negative in reverse.
    pub fn factor_at(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, SpeedLawError> {
        let speed_rpm = rpm(speed_rad_s);
        if !self.covers(speed_rpm) {
            let RangedLaw { least_rpm, most_rpm, .. } = *self;
            return Err(SpeedLawError::OutsideSpeeds {
                asked: format!("{speed_rpm:.4} r/min"),
                least_rpm,
                most_rpm,
            });
        }
        Ok(self.law.factor(pump, speed_rad_s)?)
    }

    /// `pump` with every flow and volume as at this speed, rad/s; negative in reverse.
    pub fn pump_at(&self, pump: &Pump, speed_rad_s: f64) -> Result<Pump, SpeedLawError> {
        Ok(pump.scaled(self.factor_at(pump, speed_rad_s)?)?)
    }

    /// Mean flow of `pump`, mL/s, at a speed in rad/s; both are negative in reverse.
    pub fn average_flow_ml_s(&self, pump: &Pump, speed_rad_s: f64) -> Result<f64, SpeedLawError> {
        Ok(self.factor_at(pump, speed_rad_s)? * pump.average_flow_ml_s(speed_rad_s))
    }

    /// The same up to `most_rpm`, if it holds for a slower speed; else as it is.
    pub fn up_to(self, most_rpm: f64) -> Self {
        if self.least_rpm <= most_rpm { Self { most_rpm: self.most_rpm.min(most_rpm), ..self } } else { self }
    }

    /// The largest mean flow of `pump`, mL/s.
    pub fn largest_ml_s(&self, pump: &Pump) -> Result<f64, SpeedLawError> {
        Ok(self.flow(pump, false)?.largest()?.0)
    }

    /// The slowest speed, rad/s, whose mean flow is `flow_ml_s`; both are negative in reverse.
    pub fn speed_for_flow(&self, pump: &Pump, flow_ml_s: f64) -> Result<f64, SpeedLawError> {
        let flow = self.flow(pump, flow_ml_s < 0.0)?;
        match flow.speed_rad_s(flow_ml_s.abs())? {
            Some(speed_rad_s) => Ok(speed_rad_s.copysign(flow_ml_s)),
            None => Err(self.outside_flows(pump, flow_ml_s, flow_ml_s < 0.0)?),
        }
    }

    /// The refusal of a flow that is had at no speed.
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
            // So that what a message says can be had can be had.
            least_ml_s: (flow.at(rad_s(self.least_rpm))? * 1e4).ceil() / 1e4,
            least_rpm: self.least_rpm,
            most_ml_s: (most_ml_s * 1e4).floor() / 1e4,
            at_rpm: rpm(at_rad_s),
        })
    }

    /// Mean flow against speed.
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
