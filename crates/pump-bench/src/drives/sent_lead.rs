//! The leave for the steps that are sent to the board, as the thread that asks the gate hands it to the thread that
//! streams.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use pump_ctl::plan::PlannedMotion;

use crate::drives::wire::AskClock;
use crate::drives::{Gate, Leave};

/// Times for which there is leave, and for which steps are sent.
#[derive(Debug, Clone, Copy)]
pub(in crate::drives) struct Ahead {
    /// Time of the motion for which there is leave ahead of the motor, besides the way in which it stops, in s.
    pub(in crate::drives) leave_s: f64,
    /// Time of the motion that is sent ahead of the motor, in s.
    pub(in crate::drives) sent_s: f64,
}

/// Steps beyond these times. One of them is under way. The other is due after it, and the host hears of a step only
/// once it is made: at a slow speed a motor with one step ahead would rest at each.
const BEYOND: u64 = 2;

/// Number of parts in which leave is asked for, and in which steps are sent.
const PARTS: u64 = 8;

/// Leave for the steps of a motion.
#[derive(Debug)]
pub(in crate::drives) struct SentLead<'p> {
    plan: PlannedMotion<'p>,
    ahead: Ahead,
    /// Last step that has leave. It never falls.
    left: AtomicU64,
    /// Steps made, as the board told last.
    made: AtomicU64,
    /// Steps in which the motor stops by itself from its fastest speed.
    brake_steps: u64,
    /// True once the motion is to end before its plan.
    stops: AtomicBool,
    /// True once the motion has ended.
    has_ended: AtomicBool,
}

impl<'p> SentLead<'p> {
    /// Begins with no step that has leave.
    pub(in crate::drives) fn new(plan: PlannedMotion<'p>, ahead: Ahead, brake_steps: u64) -> Self {
        Self {
            plan,
            ahead,
            left: AtomicU64::new(0),
            made: AtomicU64::new(0),
            brake_steps,
            stops: AtomicBool::new(false),
            has_ended: AtomicBool::new(false),
        }
    }

    fn all(&self) -> u64 {
        self.plan.steps().unsigned_abs()
    }

    fn left(&self) -> u64 {
        self.left.load(Ordering::Acquire)
    }

    /// Returns the last step that has leave to be sent. A motor that runs out of segments there stops within the
    /// leave.
    fn reach(&self) -> u64 {
        let left = self.left();
        if left >= self.all() { left } else { left.saturating_sub(self.brake_steps) }
    }

    /// Returns the last step that may be sent now, if those up to `sent` are: within the leave, and not too far ahead
    /// of the motor. Some steps are sent at a time.
    pub(in crate::drives) fn sendable(&self, sent: u64) -> u64 {
        let made = self.made.load(Ordering::Acquire);
        let goal = self.within(made, self.ahead.sent_s).saturating_add(BEYOND).min(self.all());
        let part = (goal.saturating_sub(made) / PARTS).max(1);
        let is_worth = match self.plan {
            PlannedMotion::Dose(_) => goal >= sent.max(made) + part,
            PlannedMotion::Flow(_) => self.is_later(goal, sent.max(made), self.ahead.sent_s),
        };
        let is_worth = goal == self.all() || is_worth;
        if is_worth { goal.min(self.reach()).max(sent) } else { sent }
    }

    /// Returns true if all that has leave is sent, up to step `sent`, and the plan goes on.
    #[cfg(feature = "node")]
    pub(in crate::drives) fn is_withheld(&self, sent: u64) -> bool {
        let reach = self.reach();
        sent >= reach && reach < self.all()
    }

    /// Notes the number of steps made.
    pub(in crate::drives) fn note_made(&self, made: u64) {
        self.made.store(made, Ordering::Release);
    }

    /// Has the motion end.
    pub(in crate::drives) fn stop(&self) {
        self.stops.store(true, Ordering::Release);
    }

    /// Returns true once the motion is to end before its plan.
    pub(in crate::drives) fn stops(&self) -> bool {
        self.stops.load(Ordering::Acquire)
    }

    /// Notes that the motion has ended.
    pub(in crate::drives) fn end(&self) {
        self.has_ended.store(true, Ordering::Release);
    }

    /// Asks `gate` for leave ahead of the motor, some steps at a time. If nothing is to be asked for, the gate may
    /// still say stop.
    pub(in crate::drives) fn ask(&self, gate: &mut Gate<'_>) {
        loop {
            if self.stops() || self.has_ended.load(Ordering::Acquire) {
                return;
            }
            let (made, left) = (self.made.load(Ordering::Acquire), self.left());
            let goal = self.goal(made);
            let part = (goal.saturating_sub(made) / PARTS).max(1);
            let is_due = match self.plan {
                PlannedMotion::Dose(_) => goal.saturating_sub(left) >= part,
                PlannedMotion::Flow(_) => {
                    self.is_later(goal.saturating_sub(self.brake_steps), self.reach(), self.ahead.leave_s)
                }
            };
            let wants = left < goal && (goal == self.all() || is_due || self.reach() <= made);
            let about_to = match self.plan {
                _ if !wants => left,
                PlannedMotion::Dose(_) => (left.max(made) + part).min(goal),
                PlannedMotion::Flow(_) => goal,
            };
            match gate(made, about_to) {
                Leave::Go => {
                    self.left.fetch_max(about_to, Ordering::AcqRel);
                }
                Leave::Wait => return,
                Leave::Stop => return self.stop(),
            }
            if !wants {
                return;
            }
        }
    }

    /// Returns true if step `goal` of a flow is due later than step `from` by a part of `ahead_s` or more. A few steps
    /// before a pause are worth as much as many in a fast flow: without them the motor would rest too early.
    fn is_later(&self, goal: u64, from: u64, ahead_s: f64) -> bool {
        goal > from && self.plan.time_of(goal) - self.plan.time_of(from) >= ahead_s / PARTS as f64
    }

    /// Returns the last step to have leave for once `made` are made.
    fn goal(&self, made: u64) -> u64 {
        let ahead = self.within(made, self.ahead.leave_s).saturating_add(BEYOND);
        ahead.saturating_add(self.brake_steps).min(self.all())
    }

    /// Returns the last step that the plan makes within `time_s` after the first `made`.
    fn within(&self, made: u64, time_s: f64) -> u64 {
        let time_of = |step: u64| self.plan.time_of(step);
        let from_s = match self.plan {
            PlannedMotion::Dose(_) => time_of(made),
            // A flow may pause and go on at once, so that the steps after its pause are sent before.
            PlannedMotion::Flow(_) => time_of((made + 1).min(self.all())),
        };
        let latest_s = from_s + time_s;
        let (mut within, mut beyond) = (made, self.all() + 1);
        while beyond - within > 1 {
            let middle = within + (beyond - within) / 2;
            if time_of(middle) <= latest_s {
                within = middle;
            } else {
                beyond = middle;
            }
        }
        within
    }
}

/// Guard of motions: however the thread that asks their gates ends, their motors stop.
pub(in crate::drives) struct Ends<'a, 'p>(
    pub(in crate::drives) &'a [SentLead<'p>],
    pub(in crate::drives) &'a dyn AskClock,
);

impl Drop for Ends<'_, '_> {
    fn drop(&mut self) {
        self.0.iter().for_each(SentLead::stop);
        self.1.end();
    }
}
