//! A series of motions that is checked as a whole before the first one begins.

use pump_ctl::plan::Plan;

use super::bench::Bench;
use super::session::Session;
use crate::dosing::{DoseError, DoseRequest, Prepared};
use crate::pump_file::PumpFile;
use crate::record::{Intent, PumpState, Purpose};

impl Session<'_> {
    /// Plans a series of motions, each from where the one before would leave the pump, within the limits of the
    /// device. Moves nothing. The safety limits are [`Session::keep_series_safe`]'s.
    ///
    /// # Errors
    ///
    /// [`DoseError`] of the first motion that cannot be planned, with its place in the series, from 0.
    pub fn prepare_series(&mut self, requests: &[DoseRequest]) -> Result<Vec<Prepared>, (usize, DoseError)> {
        let first = |error| (0, error);
        self.check_stand().map_err(first)?;
        if self.cut_off.is_none() {
            self.finished().map_err(first)?;
        }
        self.check_confirmed().map_err(first)?;
        self.connect().map_err(first)?;
        self.finished().map_err(first)?;
        let mut prepared = self.bench.plan_series(self.file(), self.state, requests)?;
        for (place, motion) in prepared.iter_mut().enumerate() {
            let checked = self.checked(motion.clone()).map_err(|error| (place, error))?;
            *motion = checked;
        }
        Ok(prepared)
    }
}

impl Bench {
    /// Plans a series of motions from the record, as [`Session::prepare_series`] does. Moves and writes nothing, and
    /// does not ask the device.
    ///
    /// # Errors
    ///
    /// [`DoseError`] of the first motion that cannot be planned, with its place in the series, from 0.
    pub fn prepare_series(&self, requests: &[DoseRequest]) -> Result<Vec<Prepared>, (usize, DoseError)> {
        let first = |error| (0, error);
        let state = self.state_to_plan_from().map_err(first)?;
        self.refuse_unfinished(state).map_err(first)?;
        let mut prepared = self.plan_series(self.file(), state, requests)?;
        if let Some(motion) = prepared.first_mut() {
            motion.warnings.extend(self.device_not_asked());
            motion.warnings.extend(self.confirmation_missing(state.as_ref()));
        }
        Ok(prepared)
    }

    fn plan_series(
        &self,
        file: &PumpFile,
        mut state: Option<PumpState>,
        requests: &[DoseRequest],
    ) -> Result<Vec<Prepared>, (usize, DoseError)> {
        let planned = |(place, request): (usize, &DoseRequest)| {
            let motion = self.prepare_from(file, state, *request, None).map_err(|error| (place, error))?;
            state = Some(self.after_motion(state, &motion, request.purpose));
            Ok(motion)
        };
        requests.iter().enumerate().map(planned).collect()
    }

    /// Returns the state of the pump once `prepared` is delivered as planned, with its retraction.
    pub(super) fn after_motion(
        &self,
        before: Option<PumpState>,
        prepared: &Prepared,
        purpose: Purpose,
    ) -> PumpState {
        let correction = prepared.correction();
        let made = |before: PumpState, plan: &Plan, purpose, carry_out_ml| {
            let intent = Intent::of(plan, correction, purpose, carry_out_ml, 0);
            let all = plan.steps().abs();
            before.after_until(intent.unix_s, &intent, all, all, self.model())
        };
        let state = made(before.unwrap_or(self.fresh()), &prepared.plan, purpose, prepared.carry_out_ml);
        match &prepared.retraction {
            Some(back) => made(state, &back.plan, Purpose::Retract, back.carry_out_ml),
            None => state,
        }
    }
}
