//! The time of every motor step.

use super::Plan;
use crate::step::Direction;

/// One motor step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Step {
    /// Number of the step, 1 for the first.
    pub number: u64,
    /// Time of the step, s since the start of motion.
    pub time_s: f64,
    /// Direction of the step.
    pub direction: Direction,
    /// Angle after the step, rad, counted on from the start angle.
    pub angle_rad: f64,
}

/// The steps of a plan in order, computed one by one. No memory is needed for each step.
#[derive(Debug, Clone)]
pub struct Steps<'a> {
    plan: &'a Plan,
    made: u64,
}

impl Plan {
    /// Returns every step with its time.
    pub fn each_step(&self) -> Steps<'_> {
        Steps { plan: self, made: 0 }
    }
}

impl Iterator for Steps<'_> {
    type Item = Step;

    fn next(&mut self) -> Option<Step> {
        if self.made == self.plan.steps.unsigned_abs() {
            return None;
        }
        self.made += 1;
        Some(Step {
            number: self.made,
            time_s: self.plan.profile.time_of(self.made as f64 * self.plan.step_rad),
            direction: self.plan.direction(),
            angle_rad: self.plan.angle_after(self.made),
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = usize::try_from(self.plan.steps.unsigned_abs() - self.made).unwrap_or(usize::MAX);
        (left, Some(left))
    }
}
