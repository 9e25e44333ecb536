//! Flows, pressures and delivered volume of a motion, sampled over time.

use pump_model::integrator::IntegrationError;
use pump_model::{ExactRun, Leg, ModelError, Port, PortRun, Pump};

/// The state of the pump at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// s.
    pub time_s: f64,
    /// Angle of the rotor, rad, unwrapped.
    pub angle_rad: f64,
    /// Speed of the rotor, rad/s.
    pub speed_rad_s: f64,
    /// Flow at the inlet rollers, mL/s.
    pub q_in_ml_s: f64,
    /// Flow at the outlet rollers, mL/s.
    pub q_out_ml_s: f64,
    /// Pressure at the inlet, kPa absolute.
    pub p_in_kpa: f64,
    /// Pressure at the outlet, kPa absolute.
    pub p_out_kpa: f64,
    /// Volume that has passed the outlet line, mL.
    pub delivered_ml: f64,
}

/// How the pressures are computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// The exact solution, between edges in closed form.
    Exact,
    /// The implicit integrator.
    Rodas5p {
        /// Error allowed in a step, see [`pump_model::DEFAULT_TOLERANCE`].
        tolerance: f64,
    },
}

impl Method {
    /// `exact` or `rodas5p`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Rodas5p { .. } => "rodas5p",
        }
    }
}

/// Follows a motion from lines at rest and samples it at rising times.
pub struct Waveform<'a, M> {
    pump: &'a Pump,
    legs: M,
    leg: Leg,
    start_ml: f64,
    ports: Ports<'a, M>,
}

/// Both ports by either method.
enum Ports<'a, M> {
    Exact(Box<[ExactRun<'a, M>; 2]>),
    Integrated(Box<(PortRun<'a, M, 2>, PortRun<'a, M, 3>)>),
}

impl<'a, M: Iterator<Item = Leg> + Clone> Waveform<'a, M> {
    /// A motion over `legs`, from lines at rest; afterwards the rotor stands.
    pub fn new(
        pump: &'a Pump,
        legs: impl IntoIterator<IntoIter = M>,
        method: Method,
    ) -> Result<Self, IntegrationError> {
        let mut legs = legs.into_iter();
        let ports = match method {
            Method::Exact => {
                let run = |port| ExactRun::from_rest(pump, port, legs.clone());
                Ports::Exact(Box::new([run(Port::Inlet), run(Port::Outlet)]))
            }
            Method::Rodas5p { tolerance } => Ports::Integrated(Box::new((
                PortRun::from_rest(pump, Port::Inlet, legs.clone(), tolerance)?,
                PortRun::from_rest(pump, Port::Outlet, legs.clone(), tolerance)?,
            ))),
        };
        let leg = legs.next().unwrap_or(Leg::rest(0.0, 0.0));
        let start_ml = pump.outlet_curve().volume_ml(leg.angle_rad);
        Ok(Self { pump, legs, leg, start_ml, ports })
    }

    /// The sample at `time_s`, which must not lie before the one asked for last.
    pub fn at(&mut self, time_s: f64) -> Result<Sample, IntegrationError> {
        self.enter_leg_of(time_s);
        let (inlet_kpa, outlet_kpa, through_ml) = match &mut self.ports {
            Ports::Exact(ports) => (ports[0].at(time_s)[0], ports[1].at(time_s)[0], None),
            Ports::Integrated(ports) => {
                let (inlet, outlet) = (ports.0.at(time_s)?, ports.1.at(time_s)?);
                (inlet[0], outlet[0], Some(outlet[2]))
            }
        };
        Ok(self.sample(time_s, inlet_kpa, outlet_kpa, through_ml))
    }

    fn enter_leg_of(&mut self, time_s: f64) {
        while time_s >= self.leg.end_s() {
            let rest = Leg::rest(self.leg.end_s(), self.leg.end_angle_rad());
            self.leg = self.legs.next().unwrap_or(rest);
        }
    }

    /// A sample from pressures above the reservoirs. The volume through the outlet line is, by the balance of the
    /// exact solution, what the rollers pushed less what the line holds, unless it was integrated itself.
    fn sample(&self, time_s: f64, inlet_kpa: f64, outlet_kpa: f64, through_ml: Option<f64>) -> Sample {
        let angle_rad = self.leg.angle_at(time_s);
        let speed_rad_s = self.leg.speed_at(time_s);
        let (inlet, outlet) = (self.pump.inlet(), self.pump.outlet());
        let (inlet_ml_rad, outlet_ml_rad, volume_ml) = self.pump.at_angle(angle_rad);
        let pushed_ml = volume_ml - self.start_ml;
        Sample {
            time_s,
            angle_rad,
            speed_rad_s,
            q_in_ml_s: inlet_ml_rad * speed_rad_s,
            q_out_ml_s: outlet_ml_rad * speed_rad_s,
            p_in_kpa: inlet.reservoir_kpa + inlet_kpa,
            p_out_kpa: outlet.reservoir_kpa + outlet_kpa,
            delivered_ml: through_ml.unwrap_or(pushed_ml - outlet.compliance_ml_kpa * outlet_kpa),
        }
    }

    /// Samples at n `dt_s`, n = 0 to `intervals`: the fastest way through a motion.
    pub fn every(
        mut self,
        dt_s: f64,
        intervals: u64,
    ) -> Box<dyn Iterator<Item = Result<Sample, ModelError>> + Send + 'a>
    where
        M: Send + 'a,
    {
        let times = (0..=intervals).map(move |n| n as f64 * dt_s);
        let Ports::Exact(ports) = &self.ports else {
            return Box::new(times.map(move |time_s| Ok(self.at(time_s)?)));
        };
        let [inlet, outlet] = ports.as_ref().clone();
        let pressures = inlet.every(dt_s).zip(outlet.every(dt_s));
        Box::new(times.zip(pressures).map(move |(time_s, (inlet, outlet))| {
            self.enter_leg_of(time_s);
            Ok(self.sample(time_s, inlet[0], outlet[0], None))
        }))
    }
}

/// Times every `dt_s` from 0 to `end_s`, with `also_s` in its place and `end_s` last.
pub fn times(dt_s: f64, also_s: f64, end_s: f64) -> impl Iterator<Item = f64> {
    let mut also = Some(also_s).filter(|also| *also < end_s);
    let mut n = 0_u64;
    let mut ended = false;
    std::iter::from_fn(move || {
        if ended {
            return None;
        }
        let grid = n as f64 * dt_s;
        if let Some(extra) = also
            && extra <= grid
        {
            also = None;
            if extra < grid {
                return Some(extra);
            }
        }
        n += 1;
        if grid >= end_s {
            ended = true;
            return Some(end_s);
        }
        Some(grid)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_holds_the_last_step_and_both_ends_once() {
        let all = |dt, also, end| times(dt, also, end).collect::<Vec<_>>();
        assert_eq!(all(1.0, 1.5, 2.5), [0.0, 1.0, 1.5, 2.0, 2.5]);
        assert_eq!(all(1.0, 1.0, 2.0), [0.0, 1.0, 2.0]);
        assert_eq!(all(10.0, 1.0, 2.0), [0.0, 1.0, 2.0]);
        assert_eq!(all(1.0, 2.0, 2.0), [0.0, 1.0, 2.0]);
    }
}
