//! The volume of a run that a time or a stop ends.

use pump_ctl::Parameter;
use pump_ctl::plan::{Cruise, MAX_DURATION_S, MAX_STEPS, MAX_VOLUME_ML, PlanError};
use pump_model::Allowed;

use super::Bench;
use crate::dosing::{DoseError, DoseRequest, Prepared, cruise_of};
use crate::pump_file::PumpFile;
use crate::record::PumpState;

/// Most plans in the search for a time. Two or three are usual, and a bisection of 1e9 steps takes 30.
const MOST_ROUNDS: u32 = 40;

/// Part of a bound that a run until it is stopped goes to: the whole steps and the calibration need some room.
const WITHIN: f64 = 0.99;

/// Turns that tell the flow of a cruise.
const PROBED_TURNS: f64 = 10.0;

impl Bench {
    /// Plans a run whose motion takes `time_s` to within a motor step. On a head whose flow reverses it may take up
    /// to a pitch less or more, since no volume ends in between.
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
        if !(time_s > 0.0) {
            let (parameter, allowed) = (Parameter::Time, Allowed::Positive);
            return Err(PlanError::OutOfRange { parameter, value: time_s, allowed }.into());
        }
        let sign = f64::copysign(1.0, request.volume_ml);
        let first_ml = sign * self.flow_ml_s(file, state, request)? * time_s;
        let mut plan = self.plan_from(file, state, DoseRequest { volume_ml: first_ml, ..request }, None)?;
        let (mut fewest, mut most) = (0, None);
        for _ in 0..MOST_ROUNDS {
            let made = plan.plan.steps().unsigned_abs();
            let late_s = plan.plan.profile().duration_s() - time_s;
            let step_s = plan.plan.step_rad() / plan.plan.profile().cruise_rad_s();
            if late_s.abs() <= step_s {
                return Ok(plan);
            }
            if late_s > 0.0 { most = Some(made) } else { fewest = made }
            let next = made as f64 - late_s / step_s;
            let next = match most {
                // Steps of a smooth flow take different times, and those of a ramp longer ones.
                Some(most) if !(next > fewest as f64 && next < most as f64) => {
                    fewest + (most - fewest) / 2
                }
                _ => next.round() as u64,
            };
            if next == fewest || next == made {
                break;
            }
            let volume_ml = plan.plan.delivered_ml(&plan.model, next);
            plan = self.plan_from(file, state, DoseRequest { volume_ml, ..request }, None)?;
            // A head whose flow reverses may end elsewhere with that volume.
            if plan.plan.steps().unsigned_abs() == made {
                break;
            }
        }
        let took_s = plan.plan.profile().duration_s();
        let pitch_s = self.model().pitch_rad() / plan.plan.profile().cruise_rad_s();
        if (took_s - time_s).abs() <= pitch_s && self.model().outlet_curve().reverses() {
            return Ok(plan);
        }
        Err(PlanError::TimeTooShort { asked_s: time_s, fastest_s: took_s }.into())
    }

    /// Plans a run that goes on until somebody stops it: to the most volume, steps and time that one run may have, and
    /// within the life of the tube.
    pub(super) fn plan_until_stopped(
        &self,
        file: &PumpFile,
        state: Option<PumpState>,
        request: DoseRequest,
    ) -> Result<Prepared, DoseError> {
        if let Some(Cruise::Within { .. }) = request.cruise {
            return Err(DoseError::NoRun { why: "until it is stopped has a rate or a speed, and no time" });
        }
        let sign = f64::copysign(1.0, request.volume_ml);
        let step_ml = self.model().revolution_ml() / file.limits_with(request.pressures).motor.steps_per_rev;
        let flow_ml_s = self.flow_ml_s(file, state, request)?;
        let worn_ml = state.map_or(0.0, |state| state.wear.volume_ml);
        let left_ml = file.tube.life_ml.map_or(f64::INFINITY, |life_ml| life_ml - worn_ml);
        let most_ml = MAX_VOLUME_ML.min(MAX_STEPS * step_ml).min(MAX_DURATION_S * flow_ml_s).min(left_ml);
        // A tube that is used up refuses its smallest run.
        let volume_ml = sign * (WITHIN * most_ml).max(2.0 * step_ml);
        self.plan_from(file, state, DoseRequest { volume_ml, ..request }, None)
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
