//! The position of the motor in the past.

use super::stepper::Stepper;

impl<const Q: usize> Stepper<Q> {
    /// Returns the position at tick `t`, by the times at which the steps were due. The tick `t` must not be
    /// later than now.
    ///
    /// The result is `None` if `t` is longer ago than the segments still held, which are the last `Q` at
    /// most. The volume delivered by `t` is [`crate::plan::Plan::delivered_ml`] of the steps made since the
    /// start.
    pub fn position_at(&self, t: u64) -> Option<i64> {
        if !self.is_moving() && self.next.whole <= t {
            return Some(self.position);
        }
        let mut newest = true;
        for slot in self.queue.taken() {
            let limit = if newest { slot.segment.steps() - self.left } else { slot.segment.steps() };
            newest = false;
            if slot.began.whole <= t {
                // A step is due in the whole tick that its time lies in.
                let elapsed = ((i128::from(t) + 1) << 32) - 1 - slot.began.fixed();
                return Some(slot.position_after(slot.segment.steps_within(elapsed, limit)));
            }
        }
        None
    }
}
