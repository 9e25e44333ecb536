//! The steps of a plan at the plan's times, as long as there is leave for them.

use std::iter;

use pump_ctl::plan::Plan;
use pump_ctl::step::{Segment, TickRate, Ticks};

use super::lead::Lead;

/// Fractions of the executor in a tick, 2^32.
const FRACTIONS: f64 = 4_294_967_296.0;

/// Part of a step that is rounding.
const NEARLY: f64 = 1e-3;

/// Pace of a motion.
///
/// A speed is told by its height: the number of steps in which the plan's acceleration reaches it from rest. The
/// height rises by one a step at most. It is never above the number of steps that have leave, so the motor comes to
/// rest at the last of these, and never beyond it.
struct Pace<'a> {
    plan: &'a Plan,
    lead: &'a Lead,
    all: u64,
    tick_hz: f64,
    /// Steps that are paced.
    made: u64,
    /// Height after these steps.
    height: f64,
    /// True if the motor is as fast as the plan.
    on_plan: bool,
    /// Step at which the motor rests after a stop.
    rests_at: Option<u64>,
}

impl Pace<'_> {
    /// Returns the next step, which takes as long as `planned` if the motor may be as fast as the plan. Returns `None`
    /// where the motor comes to rest.
    fn next(&mut self, planned: Segment) -> Option<Segment> {
        if self.lead.stops() && self.rests_at.is_none() {
            self.rests_at = Some(self.made + (self.height - NEARLY).ceil().max(0.0) as u64);
        }
        let last = self.lead.left().min(self.all).min(self.rests_at.unwrap_or(self.all));
        let beyond = last.checked_sub(self.made + 1)?;
        self.made += 1;
        let planned_height = self.height_of(self.plan.speed_after(self.made));
        let most = (self.height + 1.0).min(beyond as f64);
        let is_free = planned_height <= most + NEARLY;
        let height = planned_height.min(most);
        let step =
            if is_free && self.on_plan { planned } else { slower(self.step(planned.count, height), planned) };
        (self.height, self.on_plan) = (height, is_free);
        Some(step)
    }

    /// Returns the height of a speed.
    fn height_of(&self, speed_rad_s: f64) -> f64 {
        let (acceleration_rad_s2, step_rad) =
            (self.plan.profile().acceleration_rad_s2(), self.plan.step_rad());
        speed_rad_s * speed_rad_s / (2.0 * acceleration_rad_s2 * step_rad)
    }

    /// Returns the step at whose end the speed has this height.
    fn step(&self, count: i32, height: f64) -> Segment {
        let (acceleration_rad_s2, step_rad) =
            (self.plan.profile().acceleration_rad_s2(), self.plan.step_rad());
        let speed_rad_s = |height: f64| (2.0 * acceleration_rad_s2 * step_rad * height).sqrt();
        // A step from rest to rest is fastest in its middle.
        let least_rad_s = 0.5 * (acceleration_rad_s2 * step_rad).sqrt();
        let mean_rad_s = (0.5 * (speed_rad_s(self.height) + speed_rad_s(height))).max(least_rad_s);
        let ticks = step_rad / mean_rad_s * self.tick_hz;
        Segment { count, interval: ticks as u64, frac: (ticks.fract() * FRACTIONS) as u32, add: 0 }
    }
}

/// Returns the step that takes longer. A plan may be slower than the motor makes its first step from rest.
fn slower(step: Segment, planned: Segment) -> Segment {
    if (step.interval, step.frac) < (planned.interval, planned.frac) { planned } else { step }
}

/// Returns the steps of `plan` after the first `made`, from rest, for a timer of this rate. The steps end where the
/// motor comes to rest.
pub(in crate::drives) fn steps_from<'a>(
    plan: &'a Plan,
    tick_rate: TickRate,
    lead: &'a Lead,
    made: u64,
) -> impl Iterator<Item = Segment> + 'a {
    let all = plan.steps().unsigned_abs();
    let (tick_hz, on_plan) = (f64::from(tick_rate.hz()), made == 0);
    let mut pace = Pace { plan, lead, all, tick_hz, made, height: 0.0, on_plan, rests_at: None };
    let before = usize::try_from(made).unwrap_or(usize::MAX);
    let mut planned = plan.segments(tick_rate).flat_map(one_by_one).skip(before);
    iter::from_fn(move || pace.next(planned.next()?)).fuse()
}

/// Returns a segment for each step of a segment.
fn one_by_one(segment: Segment) -> impl Iterator<Item = Segment> {
    (1..=segment.steps()).map(move |number| {
        let Ticks { whole, frac } = segment.interval_before(number);
        Segment { count: segment.count.signum(), interval: whole, frac, add: 0 }
    })
}
