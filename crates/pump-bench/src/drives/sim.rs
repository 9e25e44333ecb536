//! The simulated drive: a virtual stepper, pump, outlet line and vessel that follow every step.

use std::time::{Duration, Instant};

use pump_ctl::plan::{FlowMotion, Plan, PlannedMotion, Step};
use pump_model::circuit::{Circuit, Linear, Lumped, NoFlow, options};
use pump_model::integrator::{IntegrationError, Rodas5p};
use pump_model::{Line, Port, Pump};

use crate::displacement::Correction;
use crate::pump_file::DriverName;

use super::abilities::Abilities;
use super::drive::{Drive, Gate, Leave, Watch, wait_of};
use super::error::{DriveError, DriveFault};

/// Error allowed in a step, relative to 1 kPa plus |P - P_res|. The volume does not depend on it. At any
/// tolerance, the volume that leaves the line is the volume that the rollers pushed less the volume that the
/// line holds.
const TOLERANCE: f64 = 1e-6;

/// Volume that may still arrive when the vessel is read, in mL.
const AT_REST_ML: f64 = 1e-6;

/// Longest real time for which a wait for the vessel goes on after a stop.
const LONGEST_ANSWER: Duration = Duration::from_millis(200);

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
    /// Model of the outlet line.
    model: Lumped,
    solver: Rodas5p<3>,
    /// Correction of the displacement. The simulated pump displaces as its calibration says.
    correction: Correction,
    /// Pump with the pulse of the correction.
    pulsed: Pump,
    /// Volume in the vessel when the last plan was begun, in mL.
    begun_ml: f64,
    /// Time from the start of the last plan to its last step, in s.
    moved_s: f64,
}

impl<'a> Sim<'a> {
    /// Starts with a line at rest and an empty vessel.
    ///
    /// # Errors
    ///
    /// [`IntegrationError`] if the line is so small that no error can be allowed in a step.
    pub fn new(pump: &'a Pump) -> Result<Self, IntegrationError> {
        Self::with_tolerance(pump, TOLERANCE)
    }

    /// Starts with a line at rest and an empty vessel, and allows `tolerance` as the error in a step.
    ///
    /// # Errors
    ///
    /// [`IntegrationError`] if the tolerance is not positive.
    pub fn with_tolerance(pump: &'a Pump, tolerance: f64) -> Result<Self, IntegrationError> {
        let line = pump.outlet();
        let model = Lumped::new(line, Linear::of(line), Port::Outlet);
        let solver = Rodas5p::new(0.0, [0.0; 3], options(&model, tolerance, 1.0))?;
        Ok(Self {
            pump,
            model,
            solver,
            correction: Correction::NONE,
            pulsed: *pump,
            begun_ml: 0.0,
            moved_s: 0.0,
        })
    }

    /// Makes every step of `plan`.
    ///
    /// # Errors
    ///
    /// [`IntegrationError`] if the line cannot be integrated.
    pub fn make(&mut self, plan: &Plan) -> Result<(), IntegrationError> {
        let started_s = self.solver.time_s();
        for step in plan.each_step() {
            self.step(plan.into(), &step, started_s)?;
        }
        Ok(())
    }

    /// Lets the line flow on until `step` is due, then makes it.
    fn step(
        &mut self,
        motion: PlannedMotion<'_>,
        step: &Step,
        started_s: f64,
    ) -> Result<(), IntegrationError> {
        self.wait_until(started_s + step.time_s)?;
        let before_rad = motion.angle_after(step.number - 1);
        self.push(self.pump.outlet(), self.correction.volume_ml(&self.pulsed, before_rad, step.angle_rad));
        Ok(())
    }

    /// Makes the `steps` of a motion with leave of `gate`. Returns the number of steps made.
    fn travel(
        &mut self,
        motion: PlannedMotion<'_>,
        steps: impl Iterator<Item = Step>,
        gate: &mut Gate<'_>,
    ) -> Result<u64, DriveFault> {
        let started_s = self.solver.time_s();
        self.begun_ml = self.received_ml();
        self.moved_s = 0.0;
        let mut made = 0;
        let failed = |made: u64, error: IntegrationError| DriveFault {
            made_least: made as i64,
            made_most: made as i64 + 1,
            lost: false,
            error: error.into(),
        };
        for step in steps {
            // No time passes while the gate waits.
            let leave = loop {
                match gate(made, step.number) {
                    Leave::Wait => {}
                    leave => break leave,
                }
            };
            if leave == Leave::Stop {
                let Some(stop) = motion.stop(self.pump, made) else { break };
                let most = made + stop.steps().unsigned_abs();
                self.make(&stop)
                    .map_err(|error| DriveFault { made_most: most as i64, ..failed(made, error) })?;
                self.moved_s = self.solver.time_s() - started_s;
                return Ok(made + stop.steps().unsigned_abs());
            }
            self.step(motion, &step, started_s).map_err(|error| failed(made, error))?;
            (made, self.moved_s) = (step.number, step.time_s);
        }
        Ok(made)
    }

    /// Waits for `time_s` with the rotor at rest.
    ///
    /// # Errors
    ///
    /// [`IntegrationError`] if the line cannot be integrated.
    pub fn wait(&mut self, time_s: f64) -> Result<(), IntegrationError> {
        self.wait_until(self.solver.time_s() + time_s)
    }

    /// Waits for at least `least_s`, until nothing noticeable can still arrive: until the energy of the line
    /// is that of 1e-6 mL in its compliance. Returns false if `stopped` ended the wait.
    fn wait_for_rest(
        &mut self,
        least_s: f64,
        stopped: &mut dyn FnMut() -> bool,
    ) -> Result<bool, IntegrationError> {
        let circuit = self.at_rest();
        let least_s = self.solver.time_s() + least_s;
        let end_s = least_s + LONGEST_WAIT_S;
        while self.solver.time_s() < end_s {
            let waits = self.solver.time_s() < least_s;
            if !waits && self.holds_ml() < AT_REST_ML {
                break;
            }
            self.solver.step(&circuit, if waits { least_s } else { end_s })?;
            if stopped() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Returns the volume in the line's compliance that has the energy of the line, in mL.
    fn holds_ml(&self) -> f64 {
        let (line, state) = (self.pump.outlet(), self.solver.state());
        let stored_ml = line.compliance_ml_kpa * state[0];
        let moving_ml = state[1] / line.natural_rad_s();
        (stored_ml * stored_ml + moving_ml * moving_ml).sqrt()
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
        Circuit::new(self.model, Port::Outlet, NoFlow)
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
pub(super) const ABILITIES: Abilities = Abilities::new()
    .with_step_times(true)
    .with_angle_dependent_speed(true)
    .with_flow_over_time(true)
    .with_release(true);

impl Drive for Sim<'_> {
    fn id(&self) -> &str {
        DriverName::Sim.as_str()
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn displaces(&mut self, correction: Correction) {
        self.correction = correction;
        self.pulsed = correction.pulsed(self.pump);
    }

    fn abilities(&self) -> Abilities {
        ABILITIES
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        self.travel(plan.into(), plan.each_step(), gate)
    }

    fn check_flow(&mut self, _flow: &FlowMotion<'_>) -> Result<(), DriveError> {
        Ok(())
    }

    fn run_flow(&mut self, flow: &FlowMotion<'_>, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        self.travel(flow.into(), flow.each_step(), gate)
    }

    fn settle(&mut self, settle_s: f64, watch: &mut Watch<'_>) -> Result<Option<f64>, DriveError> {
        let mut unwanted: Option<Instant> = None;
        // The line is at rest within milliseconds of real time, so a stop only ends a wait that takes longer.
        let rests = self.wait_for_rest(wait_of(settle_s).as_secs_f64(), &mut || {
            watch().is_break() && unwanted.get_or_insert_with(Instant::now).elapsed() > LONGEST_ANSWER
        })?;
        Ok(rests.then(|| self.received_ml() - self.begun_ml))
    }

    fn simulated_s(&self) -> Option<f64> {
        Some(self.moved_s)
    }

    fn release(&mut self) -> Result<(), DriveError> {
        Ok(())
    }
}
