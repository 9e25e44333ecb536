//! The simulated drive: a virtual stepper, pump, outlet line and vessel that follow every step.

use nalgebra::SVector;
use pump_ctl::plan::Plan;
use pump_model::circuit::{Circuit, NoFlow, options};
use pump_model::integrator::{IntegrationError, Rodas5p};
use pump_model::{Line, Port, Pump};

/// Error allowed in a step, relative to 1 kPa or |P - P_res|: below 1e-6 mL over a dose.
const TOLERANCE: f64 = 1e-7;

/// Steps between two reports of progress.
const REPORT_EVERY: u64 = 1024;

/// A vessel behind an outlet line, fed by rollers that move in steps.
///
/// A step pushes its volume into the line at once, so P_out rises by dV/C; between steps the rollers stand still and
/// the line flows on by itself. The volume in the vessel is a state of its own, integrated with the line.
pub struct Sim<'a> {
    pump: &'a Pump,
    solver: Rodas5p<3>,
}

impl<'a> Sim<'a> {
    /// A line at rest and an empty vessel.
    pub fn new(pump: &'a Pump) -> Self {
        Self::with_tolerance(pump, TOLERANCE)
    }

    /// The same with another error allowed in a step.
    pub fn with_tolerance(pump: &'a Pump, tolerance: f64) -> Self {
        let solver = Rodas5p::new(0.0, SVector::zeros(), options(pump.outlet(), tolerance, 1.0));
        Self { pump, solver }
    }

    /// Makes every step of `plan`, waits `settle_s` after the last, and returns what the vessel received, mL.
    /// `progress` is told now and then how many steps are done.
    pub fn run(
        &mut self,
        plan: &Plan,
        settle_s: f64,
        mut progress: impl FnMut(u64),
    ) -> Result<f64, IntegrationError> {
        let curve = self.pump.outlet_curve();
        let line = self.pump.outlet();
        let started_s = self.solver.time_s();
        let received_ml = self.solver.state()[2];
        let mut pushed_ml = curve.volume_ml(plan.start.angle_rad);
        for step in plan.steps() {
            self.flow_until(started_s + step.time_s)?;
            let volume_ml = curve.volume_ml(step.angle_rad);
            self.push(line, volume_ml - pushed_ml);
            pushed_ml = volume_ml;
            if step.number % REPORT_EVERY == 0 {
                progress(step.number);
            }
        }
        self.flow_until(self.solver.time_s() + settle_s)?;
        Ok(self.solver.state()[2] - received_ml)
    }

    fn push(&mut self, line: &Line, volume_ml: f64) {
        let mut state = self.solver.state();
        state[0] += volume_ml / line.compliance_ml_kpa;
        self.solver.set_state(state);
    }

    fn flow_until(&mut self, time_s: f64) -> Result<(), IntegrationError> {
        let circuit = Circuit { line: self.pump.outlet(), port: Port::Outlet, forcing: NoFlow };
        while self.solver.time_s() < time_s {
            self.solver.step(&circuit, time_s)?;
        }
        Ok(())
    }
}
