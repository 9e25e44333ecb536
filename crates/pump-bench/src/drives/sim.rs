//! The simulated drive: a virtual stepper, pump, outlet line and vessel that follow every step.

use nalgebra::SVector;
use pump_ctl::plan::{Plan, Step};
use pump_model::circuit::{Circuit, Linear, NoFlow, options};
use pump_model::integrator::{IntegrationError, Rodas5p};
use pump_model::{Line, Port, Pump};

use crate::displacement::Correction;

use super::drive::{Abilities, Disturbance, Drive, DriveError, DriveFault, DriveLimits, Gate, Sought};

/// Error allowed in a step, relative to 1 kPa plus |P - P_res|. The volume does not depend on it. At any
/// tolerance, the volume that leaves the line is the volume that the rollers pushed less the volume that the
/// line holds.
const TOLERANCE: f64 = 1e-6;

/// Volume that may still arrive when the vessel is read, in mL.
const AT_REST_ML: f64 = 1e-6;

/// Longest wait for the vessel, in s.
const LONGEST_WAIT_S: f64 = 36_000.0;

/// Vessel behind an outlet line, fed by rollers that move in steps.
///
/// A step pushes its volume into the line at once, so P_out rises by dV/C. Between steps the rollers stand
/// still and the line flows on by itself. The volume in the vessel is a state of its own, integrated with the
/// line.
#[derive(Debug)]
pub struct Sim<'a> {
    pump: &'a Pump,
    solver: Rodas5p<3>,
    /// Correction of the displacement. The simulated pump displaces as its calibration says.
    correction: Correction,
    /// Volume in the vessel when the last plan was begun, in mL.
    begun_ml: f64,
}

impl<'a> Sim<'a> {
    /// Starts with a line at rest and an empty vessel.
    pub fn new(pump: &'a Pump) -> Self {
        Self::with_tolerance(pump, TOLERANCE)
    }

    /// Starts with a line at rest and an empty vessel, and allows `tolerance` as the error in a step.
    pub fn with_tolerance(pump: &'a Pump, tolerance: f64) -> Self {
        let solver = Rodas5p::new(0.0, SVector::zeros(), options(pump.outlet(), tolerance, 1.0));
        Self { pump, solver, correction: Correction::NONE, begun_ml: 0.0 }
    }

    /// Makes every step of `plan`.
    ///
    /// # Errors
    ///
    /// [`IntegrationError`] if the line cannot be integrated.
    pub fn make(&mut self, plan: &Plan) -> Result<(), IntegrationError> {
        let started_s = self.solver.time_s();
        for step in plan.steps() {
            self.step(plan, &step, started_s)?;
        }
        Ok(())
    }

    /// Lets the line flow on until `step` is due, then makes it.
    fn step(&mut self, plan: &Plan, step: &Step, started_s: f64) -> Result<(), IntegrationError> {
        self.wait_until(started_s + step.time_s)?;
        let before_rad = plan.angle_after(step.number - 1);
        self.push(self.pump.outlet(), self.correction.volume_ml(self.pump, before_rad, step.angle_rad));
        Ok(())
    }

    /// Waits for `time_s` with the rotor at rest.
    ///
    /// # Errors
    ///
    /// [`IntegrationError`] if the line cannot be integrated.
    pub fn wait(&mut self, time_s: f64) -> Result<(), IntegrationError> {
        self.wait_until(self.solver.time_s() + time_s)
    }

    /// Waits until nothing noticeable can still arrive: until the energy of the line is that of 1e-6 mL in
    /// its compliance.
    fn wait_for_rest(&mut self) -> Result<(), IntegrationError> {
        let line = self.pump.outlet();
        let circuit = self.at_rest();
        let end_s = self.solver.time_s() + LONGEST_WAIT_S;
        while self.solver.time_s() < end_s {
            let state = self.solver.state();
            let stored_ml = line.compliance_ml_kpa * state[0];
            let moving_ml = state[1] / line.natural_rad_s();
            if stored_ml * stored_ml + moving_ml * moving_ml < AT_REST_ML * AT_REST_ML {
                break;
            }
            self.solver.step(&circuit, end_s)?;
        }
        Ok(())
    }

    /// Returns the volume that the vessel has received, in mL.
    pub fn received_ml(&self) -> f64 {
        self.solver.state()[2]
    }

    /// Returns the pressure at the outlet, in kPa absolute.
    pub fn outlet_kpa(&self) -> f64 {
        self.pump.outlet().reservoir_kpa + self.solver.state()[0]
    }

    fn at_rest(&self) -> Circuit<NoFlow> {
        Circuit::new(self.pump.outlet(), Linear::of(self.pump.outlet()), Port::Outlet, NoFlow)
    }

    fn push(&mut self, line: &Line, volume_ml: f64) {
        let mut state = self.solver.state();
        state[0] += volume_ml / line.compliance_ml_kpa;
        self.solver.set_state(state);
        self.solver.restart();
    }

    fn wait_until(&mut self, time_s: f64) -> Result<(), IntegrationError> {
        let circuit = self.at_rest();
        while self.solver.time_s() < time_s {
            self.solver.step(&circuit, time_s)?;
        }
        Ok(())
    }
}

/// Abilities of the simulated drive.
pub(super) const ABILITIES: Abilities =
    Abilities { step_times: true, angle_dependent_speed: true, index: false, readback: false };

impl Drive for Sim<'_> {
    fn displaces(&mut self, correction: Correction) {
        self.correction = correction;
    }

    fn abilities(&self) -> Abilities {
        ABILITIES
    }

    fn limits(&self) -> Option<DriveLimits> {
        None
    }

    fn count(&self) -> Option<i64> {
        None
    }

    fn disturbed(&mut self) -> Option<Disturbance> {
        None
    }

    fn seek(&mut self, _plan: &Plan, _gate: &mut Gate<'_>) -> Result<Sought, DriveFault> {
        let error = DriveError::Unable {
            driver: "sim",
            ability: "index sensor",
            instead: "say where the rollers stand with `dose home --set <ANGLE>`",
        };
        Err(DriveFault { made_least: 0, made_most: 0, lost: false, error })
    }

    fn check(&mut self, _plan: &Plan) -> Result<(), DriveError> {
        Ok(())
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let started_s = self.solver.time_s();
        self.begun_ml = self.received_ml();
        let mut made = 0;
        let failed = |made_least, error: IntegrationError| DriveFault {
            made_least,
            made_most: made_least + 1,
            lost: false,
            error: error.into(),
        };
        for step in plan.steps() {
            if gate(made, step.number).is_break() {
                let Some(stop) = plan.stop(self.pump, made) else { break };
                let most = made + stop.steps.unsigned_abs();
                self.make(&stop).map_err(|error| DriveFault { made_most: most, ..failed(made, error) })?;
                return Ok(made + stop.steps.unsigned_abs());
            }
            self.step(plan, &step, started_s).map_err(|error| failed(made, error))?;
            made = step.number;
        }
        Ok(made)
    }

    fn settle(&mut self, settle_s: f64) -> Result<Option<f64>, DriveError> {
        self.wait(settle_s)?;
        self.wait_for_rest()?;
        Ok(Some(self.received_ml() - self.begun_ml))
    }

    fn notes(&mut self) -> Vec<String> {
        Vec::new()
    }

    fn release(&mut self) -> Result<(), DriveError> {
        Ok(())
    }
}
