//! Readings of the board's clock.

use std::time::Duration;

/// Reading of the board's clock: it stood at `ticks` at some time from `from` to `to` of the computer's clock.
///
/// The times are of a clock that never stands and never jumps. Either may be drawn in by what is known to have passed
/// for certain, as the time that the bytes of question and answer take on a line of a known rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drives) struct Reading<Ticks = u32> {
    /// Time before which the board cannot have read its clock, as that at which the question was sent.
    pub(in crate::drives) from: Duration,
    /// Time after which the board cannot have read its clock, as that at which the answer came.
    pub(in crate::drives) to: Duration,
    /// Ticks of the board's clock.
    pub(in crate::drives) ticks: Ticks,
}
