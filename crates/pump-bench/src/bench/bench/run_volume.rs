//! The volume of a run that a time or a stop ends.

mod time_search;

use pump_ctl::Parameter;
use pump_ctl::plan::{Cruise, MAX_DURATION_S, MAX_STEPS, MAX_VOLUME_ML, PlanError};
use pump_model::Allowed;

use self::time_search::TimeSearch;
use super::Bench;
use crate::bench::safety::RunBounds;
use crate::dosing::{DoseError, DoseRequest, Prepared, RunBound, cruise_of};
use crate::numbers::{duration, significant};
use crate::pump_file::PumpFile;
use crate::record::{PumpState, Wear};

/// Most plans in the search for a time at constant ramps. Two or three are usual.
const NEWTON_ROUNDS: u32 = 8;

/// Most plans of the bisection between two neighbours.
const MOST_ROUNDS: u32 = 40;

/// Part of a bound that a run until it is stopped goes to: the whole steps and the calibration need some room.
const WITHIN: f64 = 0.99;

/// Turns that tell the flow of a cruise.
const PROBED_TURNS: f64 = 10.0;

impl Bench {
    /// Plans a run whose motion takes `time_s` to within a motor step, or as near to it as its ramps allow.
    pub(super) fn plan_for_time(
        &self,
        file: &PumpFile,
        state: Option<PumpState>,
        request: DoseRequest,
        time_s: f64,
    ) -> Result<Prepared, DoseError> {
        if let Some(Cruise::Within { .. }) = request.cruise {
            return Err(DoseError::NoRun { why: "for a time has a rate or a speed, and no second time" });
        }
        if time_s > MAX_DURATION_S {
            return Err(PlanError::TooSlow { duration_s: time_s }.into());
        }
        if time_s.is_nan() || time_s <= 0.0 {
            let (parameter, allowed) = (Parameter::Time, Allowed::Positive);
            return Err(PlanError::OutOfRange { parameter, value: time_s, allowed }.into());
        }
        let flow_ml_s = self.flow_ml_s(file, state, request)?;
        let first_ml = f64::copysign(flow_ml_s * time_s, request.volume_ml);
        let plan = |volume_ml| self.plan_from(file, state, DoseRequest { volume_ml, ..request }, None);
        let mut search = TimeSearch::from(plan(first_ml)?, time_s, flow_ml_s);
        for _ in 0..NEWTON_ROUNDS {
            let Some(volume_ml) = search.next_ml() else { break };
            search.take(plan(volume_ml)?);
        }
        // The ramps that leave the line nearly at rest change from angle to angle, and the time with them.
        for volume_ml in search.neighbours_ml() {
            if search.is_done() {
                break;
            }
            search.take(plan(volume_ml)?);
        }
        for _ in 0..MOST_ROUNDS {
            let Some(volume_ml) = search.between_ml() else { break };
            search.take(plan(volume_ml)?);
        }
        search.found()
    }

    /// Plans a run that goes on until somebody stops it: to the most volume, steps and time that one run may have,
    /// within the life of the tube, the safety limits and the steps that the device can count.
    pub(super) fn plan_until_stopped(
        &self,
        file: &PumpFile,
        state: Option<PumpState>,
        request: DoseRequest,
        most: Option<RunBounds>,
    ) -> Result<Prepared, DoseError> {
        if let Some(Cruise::Within { .. }) = request.cruise {
            return Err(DoseError::NoRun { why: "until it is stopped has a rate or a speed, and no time" });
        }
        let step_ml = self.model().revolution_ml() / file.limits_with(request.pressures).motor.steps_per_rev;
        let flow_ml_s = self.flow_ml_s(file, state, request)?;
        let left_ml = self.tube_left_ml(file, state, flow_ml_s);
        let counted_ml =
            most.and_then(|most| most.steps).map_or(f64::INFINITY, |steps| steps as f64 * step_ml);
        let any_ml = MAX_VOLUME_ML.min(MAX_STEPS * step_ml).min(MAX_DURATION_S * flow_ml_s);
        let safe_ml = most.map_or(f64::INFINITY, |most| most.safe_ml());
        let most_ml = any_ml.min(left_ml).min(counted_ml).min(safe_ml);
        // A tube that is used up refuses its smallest run, and so does a device that counts no further.
        let volume_ml = f64::copysign((WITHIN * most_ml).max(2.0 * step_ml), request.volume_ml);
        let mut plan = self.plan_from(file, state, DoseRequest { volume_ml, ..request }, None)?;
        let volume = significant(volume_ml.abs(), 4);
        if counted_ml < any_ml.min(left_ml).min(safe_ml) {
            let text = format!(
                "the device counts its steps exactly for {volume} mL from here, so the run ends after {} at the \
                 latest; a device that is switched off and on counts from zero",
                duration(plan.plan.profile().duration_s())
            );
            plan.warnings.push(text.into());
        }
        if safe_ml < any_ml.min(left_ml).min(counted_ml) {
            let text = format!(
                "the safety limits leave {} mL, so the run ends by itself after {volume} mL, in {}, and the pump then \
                 stands",
                significant(safe_ml, 4),
                duration(plan.plan.profile().duration_s())
            );
            plan.warnings.push(text.into());
        }
        plan.ends_at = Some(match most.and_then(|most| most.safety) {
            Some(stand) if safe_ml < any_ml.min(left_ml).min(counted_ml) => RunBound::Safety(stand.limit),
            _ if counted_ml < any_ml.min(left_ml) => RunBound::Count,
            _ if left_ml < any_ml => RunBound::Tube,
            _ => RunBound::Most,
        });
        Ok(plan)
    }

    /// Returns the volume for which the tube lasts at a flow, in mL. Infinite if the pump file gives no life.
    fn tube_left_ml(&self, file: &PumpFile, state: Option<PumpState>, flow_ml_s: f64) -> f64 {
        let worn = state.map_or(Wear::default(), |state| state.wear);
        let left_ml = file.tube.life_ml.map(|life_ml| life_ml - worn.volume_ml);
        let left_rev = file.tube.life_rev.map(|life_rev| life_rev - worn.revolutions);
        let left_s = file.tube.life_h.map(|life_h| 3600.0 * life_h - worn.motion_s);
        let of_time_ml = left_s.map(|left_s| left_s * flow_ml_s);
        let of_turns_ml = left_rev.map(|left_rev| left_rev * self.model().revolution_ml());
        [left_ml, of_turns_ml, of_time_ml].into_iter().flatten().fold(f64::INFINITY, f64::min)
    }

    /// Returns the mean flow of the cruise that a request asks for, in mL/s, positive.
    fn flow_ml_s(
        &self,
        file: &PumpFile,
        state: Option<PumpState>,
        request: DoseRequest,
    ) -> Result<f64, DoseError> {
        if let Cruise::Flow { ml_s } = cruise_of(&request, file) {
            return Ok(ml_s);
        }
        let volume_ml = f64::copysign(PROBED_TURNS * self.model().revolution_ml(), request.volume_ml);
        let probe = self.plan_from(file, state, DoseRequest { volume_ml, ..request }, None)?;
        Ok(probe.plan.cruise_flow_ml_s(&probe.model))
    }
}
