//! The search for the number of steps whose motion takes a given time.

use pump_ctl::plan::PlanError;

use crate::dosing::{DoseError, Prepared};

/// Number of neighbours at which the time is looked at.
const NEIGHBOURS: i64 = 64;

/// Distance of the farthest neighbours, in times of the distance that is left.
const REACH: f64 = 4.0;

/// Part of the time by which a run may be shorter or longer where no end meets the time to a step.
const NEAR: f64 = 0.01;

/// Plans with their steps and the time by which each is late.
pub(super) struct TimeSearch {
    time_s: f64,
    /// Flow that was asked for, in mL/s, positive.
    flow_ml_s: f64,
    best: Prepared,
    /// Steps of the plans so far, and the time by which each is late, in s.
    seen: Vec<(u64, f64)>,
}

impl TimeSearch {
    pub(super) fn from(first: Prepared, time_s: f64, flow_ml_s: f64) -> Self {
        let seen = vec![(first.plan.steps().unsigned_abs(), first.plan.profile().duration_s() - time_s)];
        Self { time_s, flow_ml_s, best: first, seen }
    }

    /// Takes a plan into account.
    pub(super) fn take(&mut self, plan: Prepared) {
        let late_s = plan.plan.profile().duration_s() - self.time_s;
        self.seen.push((plan.plan.steps().unsigned_abs(), late_s));
        if late_s.abs() < self.late_s().abs() {
            self.best = plan;
        }
    }

    /// Returns true if the best plan meets the time to a step.
    pub(super) fn is_done(&self) -> bool {
        self.late_s().abs() <= self.step_s()
    }

    /// Returns the volume to try next as if ramps were constant, in mL. `None` if the search is done, or if that was
    /// tried.
    pub(super) fn next_ml(&self) -> Option<f64> {
        let (made, late_s) = *self.seen.last()?;
        let next = (made as f64 - late_s / self.step_s()).round().max(1.0) as u64;
        self.untried_ml(next)
    }

    /// Returns volumes on either side of the best one, in mL.
    pub(super) fn neighbours_ml(&self) -> Vec<f64> {
        let made = self.best.plan.steps().unsigned_abs() as f64;
        let reach = REACH * self.late_s().abs() / self.step_s();
        let nearby = (-NEIGHBOURS / 2..=NEIGHBOURS / 2)
            .map(|n| (made + reach * n as f64 / (NEIGHBOURS / 2) as f64).round().max(1.0) as u64);
        nearby.filter_map(|steps| self.untried_ml(steps)).collect()
    }

    /// Returns the volume midway between two neighbours of which one is early and one is late, in mL: those whose
    /// times are nearest to each other. `None` if the search is done, or if there are none.
    pub(super) fn between_ml(&self) -> Option<f64> {
        let mut seen = self.seen.clone();
        seen.sort_by_key(|(made, _)| *made);
        let pairs = seen.windows(2).filter_map(|pair| {
            let [(fewer, early_s), (more, late_s)] = *pair else { return None };
            let is_between = early_s <= 0.0 && late_s >= 0.0 && more - fewer > 1;
            // A jump of the ramps' time leaves a distance whatever the number of steps.
            let jump_s = late_s - early_s - (more - fewer) as f64 * self.step_s();
            is_between.then_some((jump_s.abs(), fewer + (more - fewer) / 2))
        });
        let (_, middle) = pairs.min_by(|a, b| a.0.total_cmp(&b.0))?;
        self.untried_ml(middle)
    }

    /// Returns the plan that comes nearest to the time.
    ///
    /// # Errors
    ///
    /// [`PlanError::TimeTooShort`] if no plan comes near.
    pub(super) fn found(self) -> Result<Prepared, DoseError> {
        let (late_s, asked_s) = (self.late_s(), self.time_s);
        // A run too short for its ramps is slower than asked for, and its steps take longer.
        let plan = &self.best.plan;
        let asked_step_s = self.best.model.average_flow_ml_s(plan.step_rad()) / self.flow_ml_s;
        if late_s.abs() <= asked_step_s.max(NEAR * asked_s) {
            return Ok(self.best);
        }
        Err(PlanError::too_short(asked_s, self.best.plan.profile().duration_s()).into())
    }

    /// Returns the volume of so many steps, in mL, unless the search is done or they were tried.
    fn untried_ml(&self, steps: u64) -> Option<f64> {
        let is_new = !self.is_done() && self.seen.iter().all(|(made, _)| *made != steps);
        is_new.then(|| self.best.plan.delivered_ml(&self.best.model, steps))
    }

    /// Returns the time by which the best plan is late, in s.
    fn late_s(&self) -> f64 {
        self.best.plan.profile().duration_s() - self.time_s
    }

    /// Returns the time of a step while cruising, in s.
    fn step_s(&self) -> f64 {
        self.best.plan.step_rad() / self.best.plan.profile().cruise_rad_s()
    }
}
