//! Faults of a motor that turns.

use thiserror::Error;

use crate::step::{PushError, StartError};

/// A step that failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StepFault<E> {
    /// Error of the back end.
    pub error: E,
    /// True if the motor has made the step all the same.
    pub made: bool,
}

/// A move that ended early, or did not begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Fault<E> {
    /// The back end failed. The motor made no further step; the position is right.
    #[error("the motor's driver failed at position {position}: {error:?}")]
    Motion {
        /// Error of the back end.
        error: E,
        /// Steps made, signed.
        position: i64,
    },
    /// The queue of segments ran dry; the motor was decelerated and holds.
    #[error("the queue of segments ran dry; the motor was decelerated and holds at position {position}")]
    Starved {
        /// Steps made, signed.
        position: i64,
    },
    /// A step came later than the one after it was due; the motor was decelerated and holds.
    #[error(
        "a step came {late_ticks} ticks late, when the next was due already; the motor was decelerated and holds at \
         position {position}: give the timer's interrupt a higher priority, or dose more slowly"
    )]
    Late {
        /// Delay of the step, ticks.
        late_ticks: u64,
        /// Steps made, signed.
        position: i64,
    },
    /// The motor is not enabled.
    #[error("the motor is not enabled; call enable() first")]
    NotEnabled,
    /// A segment was refused.
    #[error(transparent)]
    Push(#[from] PushError),
    /// The move was refused.
    #[error(transparent)]
    Start(#[from] StartError),
}
