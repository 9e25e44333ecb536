//! The pace of a simulated run that goes on until it is stopped: real time, since a person ends it by time.

use std::ops::ControlFlow;
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_ctl::plan::Plan;

use crate::dosing::{Prepared, RunEnd};

/// Longest sleep between two calls of the caller's watch.
const SLICE: Duration = Duration::from_millis(20);

/// Pace of a motion under way.
#[derive(Debug)]
pub(super) struct Pace<'p> {
    /// Plan whose times are kept. `None` if the drive itself takes the time, or none is to pass.
    plan: Option<&'p Plan>,
    /// Instant of the first call.
    began: Option<Instant>,
}

impl<'p> Pace<'p> {
    /// Makes the pace of a motion that is about to begin.
    pub(super) fn of(prepared: &'p Prepared, is_simulated: bool) -> Self {
        let is_kept = is_simulated && prepared.request.end == RunEnd::Stop;
        Self { plan: is_kept.then_some(&prepared.plan), began: None }
    }

    /// Calls `watch` until the first `made` steps are due, or it breaks.
    pub(super) fn watch(
        &mut self,
        made: u64,
        watch: &mut impl FnMut(u64) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let began = *self.began.get_or_insert_with(Instant::now);
        loop {
            watch(made)?;
            let Some(plan) = self.plan else { return ControlFlow::Continue(()) };
            let due_s = plan.profile().time_of(made as f64 * plan.step_rad());
            let left = Duration::from_secs_f64(due_s).saturating_sub(began.elapsed());
            if left.is_zero() {
                return ControlFlow::Continue(());
            }
            sleep(left.min(SLICE));
        }
    }
}
