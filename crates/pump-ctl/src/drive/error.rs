//! Faults of a motor that turns.

use thiserror::Error;

use crate::step::{PushError, StartError};

/// A move that ended early, or did not begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Fault<E> {
    /// The back end failed. The motor made no further step, and the position is right.
    #[error("the motor's driver failed at position {position}: {error:?}")]
    Motor {
        /// Error of the back end.
        error: E,
        /// Position of the motor, signed steps.
        position: i64,
    },
    /// The queue of segments ran dry. The motor was decelerated and holds.
    #[error("the queue of segments ran dry; the motor was decelerated and holds at position {position}")]
    Starved {
        /// Position of the motor, signed steps.
        position: i64,
    },
    /// A step came so late that the next step was due already. The motor was decelerated and holds.
    #[error(
        "a step came {late_ticks} ticks late, when the next one was due already; the motor was decelerated \
         and holds at position {position}: give the timer's interrupt a higher priority, or dose more slowly"
    )]
    Late {
        /// Delay of the step, ticks.
        late_ticks: u64,
        /// Position of the motor, signed steps.
        position: i64,
    },
    /// The motor is not enabled.
    #[error("the motor is not enabled; call enable() first")]
    NotEnabled,
    /// The executor refused a segment.
    #[error(transparent)]
    Push(#[from] PushError),
    /// The executor refused to start the move.
    #[error(transparent)]
    Start(#[from] StartError),
}
