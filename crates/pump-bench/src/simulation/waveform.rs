//! Flows, pressures and the delivered volume of a motion, sampled over time.

use pump_model::circuit::Loss;
use pump_model::integrator::IntegrationError;
use pump_model::{
    ExactRun, ExactSamples, ExactSeries, Friction, Leg, LineState, ModelError, Port, PortRun, Pump,
    RollerCentric, RollerRun, SteadyState,
};

use crate::simulation::{Columns, EqualTimes, Sample};

/// A method that computes the pressures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Exact solution of the flow-centric model, in closed form between edges.
    Exact,
    /// Implicit integrator RODAS5P.
    Rodas5p(Integration),
    /// Implicit integrator by Radau's method, of the flow-centric model with the R of its lines.
    Radau {
        /// Error that a step may have, see [`pump_model::DEFAULT_TOLERANCE`].
        tolerance: f64,
    },
}

/// The settings of RODAS5P.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integration {
    /// Error that a step may have, see [`pump_model::DEFAULT_TOLERANCE`].
    pub tolerance: f64,
    /// Frictions of the hoses of inlet and outlet, which replace R. `None` for a line that is given by its R.
    pub frictions: [Option<Friction>; 2],
    /// Parameters of the roller-centric model. `None` is the flow-centric model.
    pub roller_centric: Option<RollerCentric>,
}

impl Integration {
    /// Makes the settings for the flow-centric model with the R of its lines.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, frictions: [None; 2], roller_centric: None }
    }

    /// Returns the losses of the inlet line and the outlet line of `pump`.
    pub(super) fn losses(&self, pump: &Pump) -> [Loss; 2] {
        let [inlet, outlet] = self.frictions;
        [Loss::with_friction(pump.inlet(), inlet), Loss::with_friction(pump.outlet(), outlet)]
    }
}

impl Method {
    /// Returns the method's name, `exact`, `rodas5p` or `radau`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Rodas5p(_) => "rodas5p",
            Self::Radau { .. } => "radau",
        }
    }

    /// Returns the periodic steady state of `pump` at a constant speed in rad/s, in closed form where there
    /// is one.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a speed that the model refuses, or of an integration that fails.
    pub fn steady_state(&self, pump: &Pump, speed_rad_s: f64) -> Result<SteadyState, ModelError> {
        match self {
            Self::Rodas5p(integration) => match integration.roller_centric {
                Some(model) => model.resisted_steady_state(pump, integration.losses(pump), speed_rad_s),
                None if integration.frictions == [None; 2] => pump.steady_state(speed_rad_s),
                None => pump.resisted_steady_state(integration.losses(pump), speed_rad_s),
            },
            Self::Exact | Self::Radau { .. } => pump.steady_state(speed_rad_s),
        }
    }
}

/// Samples of a motion at rising times.
///
/// As an iterator it gives them one by one; [`Waveform::fill`] is faster and gives them in columns.
#[derive(Debug)]
pub struct Waveform<'a, M, T> {
    pump: &'a Pump,
    times: T,
    legs: M,
    leg: Leg,
    /// Volume of the outlet's rollers and of its line at the start, mL.
    start_ml: f64,
    held_ml: f64,
    /// Time of the last sample, in s.
    last_s: f64,
    ports: Ports<'a, M>,
}

/// Starts the integration of a port from the state of its line.
fn resisted<'a, M: Iterator<Item = Leg>, const N: usize>(
    pump: &'a Pump,
    port: Port,
    [inlet, outlet]: [(Loss, LineState); 2],
    legs: M,
    tolerance: f64,
) -> Result<PortRun<'a, M, N, Loss>, IntegrationError> {
    let (loss, state) = match port {
        Port::Inlet => inlet,
        Port::Outlet => outlet,
    };
    PortRun::resisted(pump, loss, port, legs, state, tolerance)
}

/// The source of the pressures, by model.
#[derive(Debug)]
enum Ports<'a, M> {
    FlowCentric(Lines<'a, M>),
    RollerCentric(Box<RollerRun<'a, M>>),
}

/// Inlet and outlet of the flow-centric model, by method.
#[derive(Debug)]
enum Lines<'a, M> {
    Exact(Box<[ExactSeries<'a, M>; 2]>),
    /// Exact solution at the next of equal intervals. The time itself is not looked at.
    Every(Box<[ExactSamples<'a, M>; 2]>),
    Integrated(Box<(PortRun<'a, M, 2, Loss>, PortRun<'a, M, 3, Loss>)>),
}

impl<'a, M: Iterator<Item = Leg> + Clone> Waveform<'a, M, EqualTimes> {
    /// Samples a motion at n `dt_s`, n = 0 to `intervals`, which is the fastest way. The `legs` start at time
    /// 0, and the lines of inlet and outlet in `states`.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of an integrator that cannot start.
    pub fn every(
        pump: &'a Pump,
        legs: impl IntoIterator<IntoIter = M>,
        method: Method,
        (dt_s, intervals): (f64, u64),
        states: [LineState; 2],
    ) -> Result<Self, ModelError> {
        let waveform = Self::starting(pump, legs, method, EqualTimes::new(dt_s, intervals), states)?;
        Ok(waveform.at_equal_intervals(dt_s))
    }
}

impl<'a, M: Iterator<Item = Leg> + Clone, T: Iterator<Item = f64>> Waveform<'a, M, T> {
    /// Samples a motion over `legs` at `times` in s, which must rise, from lines at rest. After the last leg the
    /// rotor stands.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of an integrator that cannot start.
    pub fn new(
        pump: &'a Pump,
        legs: impl IntoIterator<IntoIter = M>,
        method: Method,
        times: T,
    ) -> Result<Self, ModelError> {
        Self::starting(pump, legs, method, times, [LineState::AT_REST; 2])
    }

    /// Samples a motion as [`Waveform::new`] does, from the states of the lines of inlet and outlet.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of an integrator that cannot start, or of a model that starts from rest alone.
    pub fn starting(
        pump: &'a Pump,
        legs: impl IntoIterator<IntoIter = M>,
        method: Method,
        times: T,
        states: [LineState; 2],
    ) -> Result<Self, ModelError> {
        let [inlet, outlet] = states;
        let mut legs = legs.into_iter();
        let ports = match method {
            Method::Exact => {
                let run = |port, state| ExactRun::new(pump, port, legs.clone(), state).in_series();
                let ports = [run(Port::Inlet, inlet), run(Port::Outlet, outlet)];
                Ports::FlowCentric(Lines::Exact(Box::new(ports)))
            }
            Method::Radau { tolerance } => {
                let [resists_inlet, resists_outlet] = Integration::new(tolerance).losses(pump);
                let starts = [(resists_inlet, inlet), (resists_outlet, outlet)];
                Ports::FlowCentric(Lines::Integrated(Box::new((
                    resisted(pump, Port::Inlet, starts, legs.clone(), tolerance)?.with_radau()?,
                    resisted(pump, Port::Outlet, starts, legs.clone(), tolerance)?.with_radau()?,
                ))))
            }
            Method::Rodas5p(integration) => {
                let Integration { tolerance, roller_centric, .. } = integration;
                let losses = integration.losses(pump);
                match roller_centric {
                    Some(_) if states != [LineState::AT_REST; 2] => return Err(ModelError::StartsFromRest),
                    Some(model) => {
                        let run = RollerRun::resisted(pump, model, losses, legs.clone(), tolerance)?;
                        Ports::RollerCentric(Box::new(run))
                    }
                    None => {
                        let [resists_inlet, resists_outlet] = losses;
                        let starts = [(resists_inlet, inlet), (resists_outlet, outlet)];
                        Ports::FlowCentric(Lines::Integrated(Box::new((
                            resisted(pump, Port::Inlet, starts, legs.clone(), tolerance)?,
                            resisted(pump, Port::Outlet, starts, legs.clone(), tolerance)?,
                        ))))
                    }
                }
            }
        };
        let leg = legs.next().unwrap_or(Leg::rest(0.0, 0.0));
        // A volume that the line holds at the start passes it without a turn.
        let held_ml = pump.outlet().compliance_ml_kpa * outlet.above_reservoir_kpa;
        let start_ml = pump.outlet_curve().volume_ml(leg.angle_rad);
        Ok(Self { pump, times, legs, leg, start_ml, held_ml, last_s: leg.start_s, ports })
    }

    /// Returns this waveform, of which no sample was taken yet, for times that are n `dt_s` to rounding, n from 0 on.
    /// [`interval_s`](super::interval_s) tells such times. The exact solution takes the least for them.
    #[must_use]
    pub fn at_equal_intervals(self, dt_s: f64) -> Self {
        let ports = match self.ports {
            // The intervals count from the start of the legs.
            Ports::FlowCentric(Lines::Exact(ports)) if self.leg.start_s == 0.0 => {
                Ports::FlowCentric(Lines::Every(Box::new(ports.map(|run| run.into_run().every(dt_s)))))
            }
            other => other,
        };
        Self { ports, ..self }
    }

    /// Returns the states of the lines of inlet and outlet at the last sample, from which a later run may go on;
    /// `None` for the roller-centric model, whose state is more than that of its lines.
    ///
    /// # Errors
    /// Returns the [`IntegrationError`] of a step that fails.
    pub fn end_states(&mut self) -> Result<Option<[LineState; 2]>, IntegrationError> {
        Ok(match &mut self.ports {
            Ports::RollerCentric(_) => None,
            Ports::FlowCentric(Lines::Exact(ports)) => Some(ports.each_ref().map(ExactSeries::state)),
            Ports::FlowCentric(Lines::Every(ports)) => Some(ports.each_ref().map(ExactSamples::state)),
            Ports::FlowCentric(Lines::Integrated(ports)) => {
                Some([ports.0.at(self.last_s)?, ports.1.at(self.last_s)?])
            }
        })
    }

    /// Returns the pressures of the reservoirs of inlet and outlet, in kPa absolute.
    pub fn reservoirs_kpa(&self) -> [f64; 2] {
        [self.pump.inlet().reservoir_kpa, self.pump.outlet().reservoir_kpa]
    }

    /// Fills the columns with the next samples and returns their number. A number below the length of the
    /// columns is the end.
    ///
    /// # Errors
    /// Returns the [`IntegrationError`] of a step that fails.
    pub fn fill(&mut self, columns: Columns<'_>) -> Result<usize, IntegrationError> {
        let mut count = 0;
        for (place, time) in columns[0].iter_mut().zip(&mut self.times) {
            *place = time;
            count += 1;
        }
        let [time_s, angle_rad, speed_rad_s, q_in_ml_s, q_out_ml_s, p_in_kpa, p_out_kpa, delivered_ml] =
            columns.map(|column| &mut column[..count]);
        self.last_s = time_s.last().copied().unwrap_or(self.last_s);
        self.follow_legs(time_s, angle_rad, speed_rad_s);
        // Flows per angle until they are multiplied by the speed.
        self.pump.at_angles(angle_rad, q_in_ml_s, q_out_ml_s, delivered_ml);
        for n in 0..count {
            q_in_ml_s[n] *= speed_rad_s[n];
            q_out_ml_s[n] *= speed_rad_s[n];
            delivered_ml[n] -= self.start_ml;
        }
        match &mut self.ports {
            Ports::FlowCentric(lines) => {
                lines.follow(
                    self.pump,
                    time_s,
                    [&mut *p_in_kpa, &mut *p_out_kpa],
                    delivered_ml,
                    self.held_ml,
                )?;
                for n in 0..count {
                    p_in_kpa[n] += self.pump.inlet().reservoir_kpa;
                    p_out_kpa[n] += self.pump.outlet().reservoir_kpa;
                }
            }
            Ports::RollerCentric(run) => {
                for n in 0..count {
                    let sample = run.at(time_s[n])?;
                    (p_in_kpa[n], p_out_kpa[n]) = (sample.inlet_kpa, sample.outlet_kpa);
                    (q_in_ml_s[n], q_out_ml_s[n]) = (sample.inlet_ml_s, sample.outlet_ml_s);
                    delivered_ml[n] = sample.delivered_ml;
                }
            }
        }
        Ok(count)
    }

    /// Computes the angles in rad and the speeds in rad/s at the times.
    fn follow_legs(&mut self, time_s: &[f64], angle_rad: &mut [f64], speed_rad_s: &mut [f64]) {
        let mut next = 0;
        while let Some(&first_s) = time_s.get(next) {
            while first_s >= self.leg.end_s() {
                let rest = Leg::rest(self.leg.end_s(), self.leg.end_angle_rad());
                self.leg = self.legs.next().unwrap_or(rest);
            }
            let end = next + time_s[next..].partition_point(|time_s| *time_s < self.leg.end_s());
            for n in next..end {
                angle_rad[n] = self.leg.angle_at(time_s[n]);
                speed_rad_s[n] = self.leg.speed_at(time_s[n]);
            }
            next = end;
        }
    }
}

impl<M: Iterator<Item = Leg>> Lines<'_, M> {
    /// Computes the pressures above the reservoirs in kPa at the times. `through_ml` comes in as the volume
    /// that the outlet rollers have pushed and goes out as the volume that has passed the line, in mL.
    fn follow(
        &mut self,
        pump: &Pump,
        time_s: &[f64],
        [inlet_kpa, outlet_kpa]: [&mut [f64]; 2],
        through_ml: &mut [f64],
        held_ml: f64,
    ) -> Result<(), IntegrationError> {
        match self {
            Self::Exact(ports) => {
                ports[0].fill_kpa(time_s, inlet_kpa);
                ports[1].fill_kpa(time_s, outlet_kpa);
            }
            Self::Every(ports) => {
                ports[0].fill_kpa(inlet_kpa);
                ports[1].fill_kpa(outlet_kpa);
            }
            Self::Integrated(ports) => {
                for (n, time_s) in time_s.iter().enumerate() {
                    let (outlet, passed_ml) = ports.1.passed_at(*time_s)?;
                    inlet_kpa[n] = ports.0.at(*time_s)?.above_reservoir_kpa;
                    (outlet_kpa[n], through_ml[n]) = (outlet.above_reservoir_kpa, passed_ml);
                }
                return Ok(());
            }
        }
        // The exact solution balances: the volume that the line holds more than at the start has not passed it.
        for (through_ml, kpa) in through_ml.iter_mut().zip(outlet_kpa) {
            *through_ml += held_ml - pump.outlet().compliance_ml_kpa * *kpa;
        }
        Ok(())
    }
}

impl<M: Iterator<Item = Leg> + Clone, T: Iterator<Item = f64>> Iterator for Waveform<'_, M, T> {
    type Item = Result<Sample, IntegrationError>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut sample = Sample::default();
        match self.fill(sample.as_columns()) {
            Ok(0) => None,
            Ok(_) => Some(Ok(sample)),
            Err(error) => Some(Err(error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::COLUMNS;

    #[test]
    fn columns_at_equal_intervals_hold_what_single_times_give() {
        let pump = Pump::three_roller();
        let leg = |start_s, duration_s, angle_rad, speed_rad_s, acceleration_rad_s2| Leg {
            start_s,
            duration_s,
            angle_rad,
            speed_rad_s,
            acceleration_rad_s2,
        };
        // The rotor turns back in the last leg, then stands.
        let ramps =
            [leg(0.0, 0.5, 1.0, 0.0, 20.0), leg(0.5, 0.4, 3.5, 10.0, 0.0), leg(0.9, 0.6, 7.5, 10.0, -20.0)];
        let (forward, reverse) = ([Leg::constant_speed(0.0, 10.0)], [Leg::constant_speed(0.0, -10.0)]);
        let (dt_s, intervals) = (1e-3, 2000);
        for legs in [&ramps[..], &forward, &reverse] {
            let rodas5p = Method::Rodas5p(Integration::new(1e-5));
            for method in [Method::Exact, rodas5p, Method::Radau { tolerance: 1e-5 }] {
                let legs = || legs.iter().copied();
                let mut every =
                    Waveform::every(&pump, legs(), method, (dt_s, intervals), [LineState::AT_REST; 2])
                        .unwrap();
                let times = (0..=intervals).map(|n| n as f64 * dt_s);
                let mut single = Waveform::new(&pump, legs(), method, times).unwrap();
                let mut columns = [[0.0; 64]; COLUMNS];
                loop {
                    let count = every.fill(columns.each_mut().map(|column| &mut column[..])).unwrap();
                    for n in 0..count {
                        let mut expected = single.next().unwrap().unwrap();
                        for (column, expected) in columns.iter().zip(expected.as_columns()) {
                            let (found, expected) = (column[n], expected[0]);
                            assert!(
                                (found - expected).abs() <= 1e-12 * expected.abs().max(1.0),
                                "{found} {expected}"
                            );
                        }
                    }
                    if count < 64 {
                        break;
                    }
                }
                assert!(single.next().is_none());
                let [ends, single_ends] =
                    [every.end_states(), single.end_states()].map(|s| s.unwrap().unwrap());
                for (end, expected) in ends.iter().zip(single_ends) {
                    assert!((end.above_reservoir_kpa - expected.above_reservoir_kpa).abs() < 1e-12);
                    assert!((end.flow_ml_s - expected.flow_ml_s).abs() < 1e-12);
                }
            }
        }
    }
}
