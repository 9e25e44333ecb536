//! The axes, shared between the thread and the timer's interrupt.

use crate::axes::Axes;
use crate::board::{Board, Pins};

/// The axes, shared between the thread and the timer's interrupt.
///
/// A firmware takes its critical section around `act`, and sets the timer to [`Axes::next_alarm`] afterwards. Each
/// call is short: one segment, one stop, one status. It should not begin shortly before the alarm, so that no step is
/// held up.
pub trait Shared<P: Pins, B: Board, const Q: usize, const A: usize> {
    /// Calls `act` with the axes, while the interrupt is kept off.
    fn with<R>(&mut self, act: impl FnOnce(&mut Axes<'_, P, B, Q, A>) -> R) -> R;

    /// Calls `act`, after which each step is due when it was. So the timer need not be set, and the interrupt is kept
    /// off for a shorter time.
    fn with_steps_as_due<R>(&mut self, act: impl FnOnce(&mut Axes<'_, P, B, Q, A>) -> R) -> R {
        self.with(act)
    }
}

impl<P: Pins, B: Board, const Q: usize, const A: usize> Shared<P, B, Q, A> for Axes<'_, P, B, Q, A> {
    fn with<R>(&mut self, act: impl FnOnce(&mut Axes<'_, P, B, Q, A>) -> R) -> R {
        act(self)
    }
}
