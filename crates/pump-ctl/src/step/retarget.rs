//! A change of plan in the midst of a move.

use super::queue::Slot;
use super::state::StepperState;
use super::stepper::Stepper;
use super::ticks::Ticks;

/// The point at which a new plan takes over from the old one, just after the step at `at`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Junction {
    /// Position after the junction's step, signed steps.
    pub position: i64,
    /// Time at which the junction's step is due, ticks.
    pub at: u64,
    /// Interval before the junction's step, ticks. The speed is its inverse.
    pub interval: u64,
}

impl<const Q: usize> Stepper<Q> {
    /// Returns the junction for a new plan, after the first step due at `not_before` or later. The call
    /// changes nothing.
    ///
    /// The result is `None` if no such step is queued, if no step is planned after it, or if the motor is
    /// stopping.
    pub fn junction(&self, not_before: u64) -> Option<Junction> {
        let (passed, slot, k) = self.first_step_from(not_before)?;
        let ends = passed == self.queue.len() && k == slot.segment.steps();
        (!(ends && self.is_whole())).then(|| Junction {
            position: slot.position_after(k),
            at: slot.due(k).whole,
            interval: Ticks::of_fixed(slot.segment.interval_of(k)).whole,
        })
    }

    /// Drops the steps after the [`Self::junction`] for `not_before`, and returns that junction.
    ///
    /// Tell the new plan's end with [`Self::set_end`]. Until then the end of the old plan holds, if it was told.
    /// [`Self::fill`] does so by itself. Push the new plan's segments, and none of the old plan, before the junction
    /// comes. Then call [`Self::finish`]. Otherwise the motor decelerates and stands ([`super::Action::Starved`]).
    ///
    /// Plan first, from [`Self::junction`]. When there is a new plan, drop the old plan at the junction's
    /// `at`. The result is `None`, and nothing changes, if there is no junction then.
    pub fn retarget(&mut self, not_before: u64) -> Option<Junction> {
        let junction = self.junction(not_before)?;
        let (passed, _, k) = self.first_step_from(not_before)?;
        let made = self.made_of_current();
        self.queue.keep_pending(passed);
        self.queue.cut(k);
        if passed == 0 {
            self.left = k - made;
        }
        self.finished = false;
        self.queued_to = junction.position;
        Some(junction)
    }

    /// Finds the first step still to be made that is due at `not_before` or later. Returns the number of
    /// segments that end before it, its segment, and its number in that segment.
    fn first_step_from(&self, not_before: u64) -> Option<(usize, Slot, u32)> {
        if self.state != StepperState::Moving {
            return None;
        }
        let mut slot = *self.queue.current()?;
        let mut from = self.made_of_current() + 1;
        let mut passed = 0;
        let mut to_come = self.queue.pending();
        loop {
            let steps = slot.segment.steps();
            let earlier = (i128::from(not_before) << 32) - 1 - slot.began.fixed();
            let k = (slot.segment.steps_within(earlier, steps) + 1).max(from);
            if k <= steps {
                return Some((passed, slot, k));
            }
            slot =
                Slot { began: slot.due(steps), from: slot.position_after(steps), segment: *to_come.next()? };
            from = 1;
            passed += 1;
        }
    }
}
