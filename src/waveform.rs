//! Flows, pressures and delivered volume of a motion, sampled over time.

use pump_model::integrator::IntegrationError;
use pump_model::{Leg, Port, PortRun, Pump};

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

/// Follows a motion from lines at rest and samples it at rising times.
pub struct Waveform<'a, M> {
    pump: &'a Pump,
    legs: M,
    leg: Leg,
    inlet: PortRun<'a, M, 2>,
    outlet: PortRun<'a, M, 3>,
}

impl<'a, M: Iterator<Item = Leg> + Clone> Waveform<'a, M> {
    /// A motion over `legs`, from lines at rest; afterwards the rotor stands. `tolerance` as in
    /// [`pump_model::DEFAULT_TOLERANCE`].
    pub fn new(
        pump: &'a Pump,
        legs: impl IntoIterator<IntoIter = M>,
        tolerance: f64,
    ) -> Result<Self, IntegrationError> {
        let mut legs = legs.into_iter();
        let inlet = PortRun::from_rest(pump, Port::Inlet, legs.clone(), tolerance)?;
        let outlet = PortRun::from_rest(pump, Port::Outlet, legs.clone(), tolerance)?;
        let leg = legs.next().unwrap_or(Leg::rest(0.0, 0.0));
        Ok(Self { pump, legs, leg, inlet, outlet })
    }

    /// The sample at `time_s`, which must not lie before the one asked for last.
    pub fn at(&mut self, time_s: f64) -> Result<Sample, IntegrationError> {
        while time_s >= self.leg.end_s() {
            let rest = Leg::rest(self.leg.end_s(), self.leg.end_angle_rad());
            self.leg = self.legs.next().unwrap_or(rest);
        }
        let inlet = self.inlet.at(time_s)?;
        let outlet = self.outlet.at(time_s)?;
        let angle_rad = self.leg.angle_at(time_s);
        let speed_rad_s = self.leg.speed_at(time_s);
        Ok(Sample {
            time_s,
            angle_rad,
            speed_rad_s,
            q_in_ml_s: self.pump.inlet_curve().flow_ml_rad(angle_rad) * speed_rad_s,
            q_out_ml_s: self.pump.outlet_curve().flow_ml_rad(angle_rad) * speed_rad_s,
            p_in_kpa: self.pump.inlet().reservoir_kpa + inlet[0],
            p_out_kpa: self.pump.outlet().reservoir_kpa + outlet[0],
            delivered_ml: outlet[2],
        })
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
