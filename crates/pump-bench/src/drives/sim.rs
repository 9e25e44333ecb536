//! The simulated drive: a virtual stepper, pump, outlet line and vessel that follow every step.

use pump_ctl::plan::{FlowMotion, Plan, PlannedMotion, Step};
use pump_model::{LineState, Pump};

use crate::displacement::Correction;
use crate::pump_file::DriverName;

use super::abilities::Abilities;
use super::drive::{Drive, Gate, Leave, Watch, wait_of};
use super::error::{DriveError, DriveFault};

/// Volume that may still arrive when the vessel is read, in mL.
const AT_REST_ML: f64 = 1e-6;

/// Longest wait for the vessel, in s.
const LONGEST_WAIT_S: f64 = 36_000.0;

/// Shortest time between two looks whether the line rests, in s. It moves the clock on however long that has run.
const SHORTEST_STRETCH_S: f64 = 1e-3;

/// Vessel behind an outlet line, fed by rollers that move in steps.
///
/// A step pushes its volume into the line at once, so P_out rises by dV/C. Between steps the rollers stand
/// still and the line flows on by itself, which [`pump_model::Line::after`] solves exactly. The vessel has received
/// what the rollers pushed less C (P - P_res), which the line stores.
#[derive(Debug)]
pub struct Sim<'a> {
    pump: &'a Pump,
    /// Time since the drive was made, in s.
    time_s: f64,
    /// State of the outlet line.
    line: LineState,
    /// Volume that the rollers have pushed into the line, in mL.
    pushed_ml: f64,
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
    pub fn new(pump: &'a Pump) -> Self {
        Self {
            pump,
            time_s: 0.0,
            line: LineState::AT_REST,
            pushed_ml: 0.0,
            correction: Correction::NONE,
            pulsed: *pump,
            begun_ml: 0.0,
            moved_s: 0.0,
        }
    }

    /// Makes every step of `plan`.
    pub fn make(&mut self, plan: &Plan) {
        let started_s = self.time_s;
        for step in plan.each_step() {
            self.step(plan.into(), &step, started_s);
        }
    }

    /// Lets the line flow on until `step` is due, then makes it.
    fn step(&mut self, motion: PlannedMotion<'_>, step: &Step, started_s: f64) {
        self.wait_until(started_s + step.time_s);
        let before_rad = motion.angle_after(step.number - 1);
        let volume_ml = self.correction.volume_ml(&self.pulsed, before_rad, step.angle_rad);
        self.pushed_ml += volume_ml;
        self.line.above_reservoir_kpa += volume_ml / self.pump.outlet().compliance_ml_kpa;
    }

    /// Makes the `steps` of a motion with leave of `gate`. Returns the number of steps made.
    fn travel(
        &mut self,
        motion: PlannedMotion<'_>,
        steps: impl Iterator<Item = Step>,
        gate: &mut Gate<'_>,
    ) -> u64 {
        let started_s = self.time_s;
        self.begun_ml = self.received_ml();
        self.moved_s = 0.0;
        let mut made = 0;
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
                self.make(&stop);
                self.moved_s = self.time_s - started_s;
                return made + stop.steps().unsigned_abs();
            }
            self.step(motion, &step, started_s);
            (made, self.moved_s) = (step.number, step.time_s);
        }
        made
    }

    /// Waits for `time_s`, in s, with the rotor at rest.
    pub fn wait(&mut self, time_s: f64) {
        self.wait_until(self.time_s + time_s);
    }

    /// Waits for at least `least_s`, until nothing noticeable can still arrive: until the energy of the line
    /// is that of 1e-6 mL in its compliance.
    fn wait_for_rest(&mut self, least_s: f64) {
        self.wait(least_s);
        let end_s = self.time_s + LONGEST_WAIT_S;
        // A stretch leaves 1/e of each mode or less. It is endless in a line without resistance, which never rests.
        let stretch_s = (1.0 / self.pump.outlet().slowest_decay_per_s()).max(SHORTEST_STRETCH_S);
        while self.time_s < end_s && self.holds_ml() >= AT_REST_ML {
            self.wait_until((self.time_s + stretch_s).min(end_s));
        }
    }

    /// Returns the volume in the line's compliance that has the energy of the line, in mL.
    fn holds_ml(&self) -> f64 {
        let moving_ml = self.line.flow_ml_s / self.pump.outlet().natural_rad_s();
        self.stored_ml().hypot(moving_ml)
    }

    /// Returns the volume that the line stores beyond that at rest, in mL.
    fn stored_ml(&self) -> f64 {
        self.pump.outlet().compliance_ml_kpa * self.line.above_reservoir_kpa
    }

    /// Returns the volume that the vessel has received, in mL.
    pub fn received_ml(&self) -> f64 {
        self.pushed_ml - self.stored_ml()
    }

    /// Returns the pressure at the outlet, in kPa absolute.
    pub fn outlet_kpa(&self) -> f64 {
        self.line.pressure_kpa(self.pump.outlet())
    }

    fn wait_until(&mut self, time_s: f64) {
        if self.time_s < time_s {
            self.line = self.pump.outlet().after(self.line, time_s - self.time_s, 0.0);
            self.time_s = time_s;
        }
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
        Ok(self.travel(plan.into(), plan.each_step(), gate))
    }

    fn check_flow(&mut self, _flow: &FlowMotion<'_>) -> Result<(), DriveError> {
        Ok(())
    }

    fn run_flow(&mut self, flow: &FlowMotion<'_>, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        Ok(self.travel(flow.into(), flow.each_step(), gate))
    }

    fn settle(&mut self, settle_s: f64, _watch: &mut Watch<'_>) -> Result<Option<f64>, DriveError> {
        // It takes no real time, so there is nothing to stop.
        self.wait_for_rest(wait_of(settle_s).as_secs_f64());
        Ok(Some(self.received_ml() - self.begun_ml))
    }

    fn simulated_s(&self) -> Option<f64> {
        Some(self.moved_s)
    }

    fn release(&mut self) -> Result<(), DriveError> {
        Ok(())
    }
}
