//! The state of the executor.

use super::braking::WayDown;

/// The state of the executor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StepperState {
    /// The motor stands. Segments may be pushed and started.
    Ready,
    /// The motor walks the queue.
    Moving,
    /// The motor walks down to rest.
    Braking {
        /// Remainder of the way down.
        way: WayDown,
        /// True if the queue ran dry. False after a stop.
        starved: bool,
    },
    /// The motor walks the queue to its end after a stop, then down to rest unless it rests there.
    Ending {
        /// True if the queue ends at rest.
        rests: bool,
    },
    /// The motor stands after a stop. The plan no longer holds.
    Stopped,
    /// The motor stands after the queue ran dry.
    Starved,
}
