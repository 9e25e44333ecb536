//! The task of a timer interrupt.

/// The task of a timer interrupt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub enum Action {
    /// Make one step and call again at `next`. After the last step `next` is its own time: the call that follows at
    /// once tells how the move ended.
    Step {
        /// 1 forward, -1 in reverse.
        dir: i8,
        /// Time at which to call again, ticks.
        next: u64,
    },
    /// Too early: call again at [`super::Stepper::next_deadline`].
    Wait,
    /// The motor stands: the queue ran dry, and the motor was decelerated. The move is not complete.
    Starved,
    /// The motor stands, as planned or as [`super::Stepper::stop`] said.
    Done,
}
