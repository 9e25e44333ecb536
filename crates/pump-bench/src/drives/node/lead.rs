//! The leave for the steps that are sent to the board.

use pump_ctl::plan::Plan;

use crate::drives::{Gate, Leave};

/// Time of the motion for which there is leave ahead of the motor, besides the way in which it stops, in s. The
/// board's queue then holds 200 ms at least while the leave is asked for in parts and answers are under way.
const AHEAD_S: f64 = 0.6;

/// Number of parts in which leave is asked for.
const PARTS: u64 = 8;

/// Leave for the steps of a motion.
#[derive(Debug)]
pub(super) struct SentLead {
    /// Last step that has leave.
    left: u64,
    /// Steps in which the motor stops by itself from its fastest speed.
    brake_steps: u64,
    /// Steps of the plan.
    all: u64,
    /// True once the motion is to end before its plan.
    pub(super) stops: bool,
}

impl SentLead {
    /// Begins with no step that has leave.
    pub(super) fn new(all: u64, brake_steps: u64) -> Self {
        Self { left: 0, brake_steps, all, stops: false }
    }

    /// Returns the last step that may be sent. A motor that runs out of segments there stops within the leave.
    pub(super) fn reach(&self) -> u64 {
        if self.left >= self.all { self.all } else { self.left.saturating_sub(self.brake_steps) }
    }

    /// Asks `gate` for leave ahead of the first `made` steps, some at a time. If nothing is to be asked for, the gate
    /// may still say stop.
    pub(super) fn ask(&mut self, plan: &Plan, made: u64, gate: &mut Gate<'_>) {
        let goal = self.goal(plan, made);
        let part = (goal.saturating_sub(made) / PARTS).max(1);
        loop {
            let wants =
                self.left < goal && (goal == self.all || goal - self.left >= part || self.reach() <= made);
            let about_to = if wants { (self.left.max(made) + part).min(goal) } else { self.left };
            match gate(made, about_to) {
                Leave::Go => self.left = self.left.max(about_to),
                Leave::Wait => return,
                Leave::Stop => {
                    self.stops = true;
                    return;
                }
            }
            if !wants {
                return;
            }
        }
    }

    /// Returns the last step to have leave for once `made` are made.
    fn goal(&self, plan: &Plan, made: u64) -> u64 {
        let time_s = |step: u64| plan.profile().time_of(step as f64 * plan.step_rad());
        let latest_s = time_s(made) + AHEAD_S;
        let (mut within, mut beyond) = (made, self.all + 1);
        while beyond - within > 1 {
            let middle = within + (beyond - within) / 2;
            if time_s(middle) <= latest_s {
                within = middle;
            } else {
                beyond = middle;
            }
        }
        // A slow motor is asked for one step beyond, at least.
        within.max(made + 1).saturating_add(self.brake_steps).min(self.all)
    }
}
