//! The state of the executor.

use super::brake::Descent;

/// The state of the executor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    /// Stands; segments may be pushed and started.
    Ready,
    /// Walks the queue.
    Moving,
    /// Walks down the brake.
    Braking {
        /// Rest of the way down.
        descent: Descent,
        /// True if the queue ran dry, false after a stop.
        starved: bool,
    },
    /// Walks the queue to its end after a stop; then down the brake, unless it rests there.
    Ending {
        /// True if the queue ends at rest.
        rests: bool,
    },
    /// Stands after a stop; what was planned no longer holds.
    Stopped,
    /// Stands after the queue ran dry.
    Starved,
}
