//! The task of a timer interrupt.

use super::direction::Direction;

/// The task of a timer interrupt.
///
/// The enum is exhaustive on purpose: an interrupt must handle every action, so a new one is a breaking change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub enum Action {
    /// Make one step and call again at `next`. After the last step `next` is that step's own time. The call
    /// that follows at once returns how the move ended.
    Step {
        /// Direction of the step.
        direction: Direction,
        /// Time at which to call again, ticks.
        next: u64,
    },
    /// The call came too early. Call again at [`super::Stepper::next_deadline`].
    Wait,
    /// The motor stands, because the queue ran dry and the motor was decelerated. The move is not complete.
    Starved,
    /// The motor stands, as planned or as [`super::Stepper::stop`] said.
    Done,
}
