//! The pressures and the torque of a flow over time, and the first instant that a limit cannot be kept.

use pump_model::{BackFlow, ExactRun, Extremes, Leg, LineState, Port, Pump, VesselRun};

use super::error::FlowError;
use super::legs::FlowLegs;
use super::motion::FlowMotion;
use crate::plan::limits::{Limits, Margin, Margins, Torque};
use crate::plan::prediction::Prediction;
use crate::plan::words::{PlanError, SetBy};
use crate::step::Direction;

/// Looks at the torque in a leg.
const LOOKS: u32 = 4;

/// Ports of a motion under way, with the extremes so far.
struct Ports<'a> {
    runs: [ExactRun<'a, FlowLegs<'a>>; 2],
    extremes: [Extremes; 2],
}

impl<'a> FlowMotion<'a> {
    /// Predicts pressures and settling on `pump`, for the smooth motion through the steps, with the margins to
    /// `limits`.
    ///
    /// # Errors
    ///
    /// [`FlowError::Pressure`] or [`FlowError::Torque`] with the first instant at which a limit is broken.
    /// [`FlowError::Plan`] if the model cannot find the time at which the line settles.
    pub fn predict(&self, pump: &'a Pump, limits: &Limits) -> Result<(Prediction, Margins), FlowError> {
        let step_kpa = [Port::Inlet, Port::Outlet].map(|port| self.step_kpa(pump, port));
        let run = |port| ExactRun::new(pump, port, self.legs(), LineState::AT_REST);
        let at_rest = |port| Extremes::at(pump.line(port).reservoir_kpa);
        let mut ports = Ports {
            runs: [run(Port::Inlet), run(Port::Outlet)],
            extremes: [at_rest(Port::Inlet), at_rest(Port::Outlet)],
        };
        let mut torque: Option<Margin> = None;
        for leg in self.legs() {
            if let Some(of_motor) = &limits.torque {
                let worst = self.torque_of(pump, &leg, of_motor, &ports)?;
                torque = torque.into_iter().chain([worst]).max_by(|a, b| a.used.total_cmp(&b.used));
            }
            let Ports { runs: [inlet, outlet], extremes } = &mut ports;
            let reached = [inlet.extremes(leg.end_s()), outlet.extremes(leg.end_s())];
            *extremes = [extremes[0].and(reached[0]), extremes[1].and(reached[1])];
            self.check(limits, pump, reached, step_kpa, leg.end_s())?;
        }
        let end_s = self.duration_s();
        let Ports { runs: [inlet, outlet], extremes } = &mut ports;
        let settle_s = self.settle_s(pump, outlet.at(end_s))?;
        let reached = [inlet.extremes_to_rest(end_s), outlet.extremes_to_rest(end_s)];
        let [inlet, outlet] = [extremes[0].and(reached[0]), extremes[1].and(reached[1])];
        let mut margins = self.check(limits, pump, [inlet, outlet], step_kpa, end_s)?;
        margins.torque = torque;
        Ok((Prediction { inlet, outlet, step_kpa: step_kpa[0].max(step_kpa[1]), settle_s }, margins))
    }

    /// Returns the volume that the outlet's line takes back from the vessel, for the smooth motion through the steps.
    ///
    /// # Errors
    ///
    /// [`PlanError::Model`] if the line does not come to rest within an hour.
    pub fn back_flow(&self, pump: &Pump) -> Result<BackFlow, PlanError> {
        let run = ExactRun::new(pump, Port::Outlet, self.legs(), LineState::AT_REST);
        let vessel = VesselRun::new(run, self.direction == Direction::Forward);
        Ok(vessel.back_flow_to_rest(self.duration_s())?)
    }

    /// Returns the largest distance of a port's pressure from that of the smooth motion by the motor's steps, kPa.
    fn step_kpa(&self, pump: &Pump, port: Port) -> f64 {
        let largest_ml = pump.curve(port).largest_flow_ml_rad() * self.step_rad();
        let shortest_s = self.step_rad() / self.pace.peak_rad_s;
        let longest_s = self.pace.longest_interval_s.max(shortest_s);
        largest_ml * pump.line(port).worst_step_kpa_ml(shortest_s, longest_s, self.duration_s())
    }

    /// Returns the time from the last row until the undelivered volume stays below 1 uL, s. The last step's volume may
    /// have come at once just before.
    fn settle_s(&self, pump: &Pump, state: LineState) -> Result<f64, PlanError> {
        let end_rad = self.angle_after(self.all());
        let sign = f64::from(self.direction.sign());
        let step_ml = pump.outlet_curve().flow_ml_rad(end_rad) * self.step_rad() * sign;
        let above_reservoir_kpa = state.above_reservoir_kpa + step_ml / pump.outlet().compliance_ml_kpa;
        let stepped = LineState { above_reservoir_kpa, ..state };
        Ok(ExactRun::new(pump, Port::Outlet, [Leg::rest(0.0, end_rad)], stepped).settling_s()?)
    }

    /// Returns the margins of the pressures that were reached by `time_s`, or refuses the one that is broken.
    fn check(
        &self,
        limits: &Limits,
        pump: &Pump,
        reached: [Extremes; 2],
        step_kpa: [f64; 2],
        time_s: f64,
    ) -> Result<Margins, FlowError> {
        let [sucking, pushing] = Limits::ports(self.direction);
        let of = |port: Port| {
            let n = usize::from(port == Port::Outlet);
            (
                reached[n].min_kpa - step_kpa[n],
                reached[n].max_kpa + step_kpa[n],
                pump.line(port).reservoir_kpa,
            )
        };
        let (lowest_sucking, _, rest_sucking) = of(sucking);
        let (lowest_pushing, highest_pushing, rest_pushing) = of(pushing);
        let refuse = |port, reached_kpa, limit_kpa, is_most, set_by| FlowError::Pressure {
            row: self.row_number(time_s),
            time_s,
            port,
            reached_kpa,
            limit_kpa,
            is_most,
            set_by,
        };
        let mut margins = Margins::default();
        if let Some(limit) = limits.pressures.max_outlet_kpa {
            if highest_pushing > limit {
                return Err(refuse(pushing, highest_pushing, limit, true, SetBy::Given));
            }
            margins.outlet = Some(Margin::of_pressure(highest_pushing, limit, rest_pushing, 1.0));
        }
        if let Some(lowest) = limits.lowest {
            if lowest_pushing < lowest.kpa {
                return Err(refuse(pushing, lowest_pushing, lowest.kpa, false, lowest.set_by));
            }
            margins.outlet_suction =
                Some(Margin::of_pressure(lowest_pushing, lowest.kpa, rest_pushing, -1.0));
        }
        if let Some(lowest) = limits.lowest_where_it_sucks() {
            if lowest_sucking < lowest.kpa {
                return Err(refuse(sucking, lowest_sucking, lowest.kpa, false, lowest.set_by));
            }
            margins.inlet = Some(Margin::of_pressure(lowest_sucking, lowest.kpa, rest_sucking, -1.0));
        }
        Ok(margins)
    }

    /// Returns the worst margin of the torque in a leg, or refuses the first look at which the motor has too little.
    fn torque_of(
        &self,
        pump: &Pump,
        leg: &Leg,
        torque: &Torque,
        ports: &Ports<'_>,
    ) -> Result<Margin, FlowError> {
        let [mut inlet, mut outlet] = ports.runs.clone();
        let mut worst = Margin { reached: 0.0, limit: torque.motor.at(0.0), used: 0.0 };
        for look in 0..=LOOKS {
            let time_s = leg.start_s + leg.duration_s * f64::from(look) / f64::from(LOOKS);
            let angle_rad = leg.angle_at(time_s);
            let flows = [
                (inlet.pressure_kpa(time_s), pump.curve(Port::Inlet).flow_ml_rad(angle_rad)),
                (outlet.pressure_kpa(time_s), pump.curve(Port::Outlet).flow_ml_rad(angle_rad)),
            ];
            let sign = f64::from(self.direction.sign());
            let speed_rad_s = leg.speed_at(time_s).abs();
            // A rotor that rests is held by the motor's standing torque.
            let needed_n_m = torque.needed_n_m(flows, leg.acceleration_rad_s2, sign).abs();
            let margin = Margin::of_torque(needed_n_m, torque.motor.at(speed_rad_s));
            if margin.used > 1.0 && speed_rad_s > 0.0 {
                let (needed_n_m, limit_n_m) = (margin.reached, margin.limit);
                return Err(FlowError::Torque {
                    row: self.row_number(time_s),
                    time_s,
                    needed_n_m,
                    limit_n_m,
                });
            }
            if margin.used > worst.used && speed_rad_s > 0.0 {
                worst = margin;
            }
        }
        Ok(worst)
    }
}
