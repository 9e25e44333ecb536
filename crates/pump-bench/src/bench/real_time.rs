//! The real time of a simulated motion: its steps wait until they are due.

use std::ops::ControlFlow;
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_ctl::plan::PlannedMotion;

/// Longest sleep between two calls of the caller's watch.
const SLICE: Duration = Duration::from_millis(25);

/// Time by which a step may be early: a sleep for each of many thousand steps a second would make them late, and fifty
/// pumps of a service would keep a processor busy. A wake costs as much as a hundred steps.
const EARLY: Duration = Duration::from_millis(25);

/// Time by which the last step may be early, which ends the motion.
const LAST_EARLY: Duration = Duration::from_millis(1);

/// Real time of a motion under way.
#[derive(Debug)]
pub(super) struct RealTime<'p> {
    /// Motion whose times are kept. `None` if the drive itself takes the time, or none is to pass.
    plan: Option<PlannedMotion<'p>>,
    /// Instant at which the drive asked for the first step.
    began: Option<Instant>,
    /// Time of the motion until which steps are due by the last look at the clock, in s.
    due_until_s: f64,
}

impl<'p> RealTime<'p> {
    /// Makes the real time of a motion that is about to begin, if it is kept.
    pub(super) fn of(plan: PlannedMotion<'p>, is_kept: bool) -> Self {
        Self { plan: is_kept.then_some(plan), began: None, due_until_s: 0.0 }
    }

    /// Returns the time since the motion began, in s. `None` if no real time is kept.
    pub(super) fn took_s(&self) -> Option<f64> {
        self.plan.map(|_| self.began.map_or(0.0, |began| began.elapsed().as_secs_f64()))
    }

    /// Calls `watch` until the step after `made` steps is due, or it breaks.
    pub(super) fn wait(
        &mut self,
        made: u64,
        watch: &mut dyn FnMut(u64) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Some(plan) = self.plan else { return ControlFlow::Continue(()) };
        let began = *self.began.get_or_insert_with(Instant::now);
        let steps = plan.steps().unsigned_abs();
        let due_s = plan.time_of((made + 1).min(steps));
        let is_last = made + 1 >= steps;
        if due_s < self.due_until_s && !is_last {
            return ControlFlow::Continue(());
        }
        let early = if is_last { LAST_EARLY } else { EARLY };
        loop {
            let elapsed = began.elapsed();
            let left = Duration::from_secs_f64(due_s).saturating_sub(elapsed);
            if left < early {
                self.due_until_s = (elapsed + early).as_secs_f64();
                return ControlFlow::Continue(());
            }
            watch(made)?;
            sleep(left.min(SLICE));
        }
    }
}
