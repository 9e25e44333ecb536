//! Refusals of the executor.

use thiserror::Error;

use super::segment::Segment;
use super::tick_rate::TickRate;

/// The refusal of a segment. The executor is unchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PushError {
    /// The queue has no room now. Push again when a segment has been used up.
    #[error("the queue of segments is full; push again when a segment has been used up")]
    Full,
    /// The segment has no steps, or an interval shorter than one tick or longer than 2^48 ticks.
    #[error(
        "{0:?} has no steps, or an interval below 1 tick or above 2^48 ticks; for short intervals use a \
         faster timer or a slower dose, for long ones a slower timer"
    )]
    Segment(Segment),
    /// The segment is made for another timer than the brake.
    #[error(
        "the segment is made for {segments}, and the brake for {brake}; make both for the timer that fires"
    )]
    TickRate {
        /// Rate of the timer that the segment is made for.
        segments: TickRate,
        /// Rate of the timer that the brake is made for.
        brake: TickRate,
    },
    /// The segment leads away from the end of the plan or beyond it.
    #[error(
        "the segment leads to position {reaches}, and the plan ends at {end}; push segments up to the end, or \
         tell another end with set_end() first"
    )]
    Beyond {
        /// Position at which the plan comes to rest, signed steps.
        end: i64,
        /// Position after the segment, signed steps.
        reaches: i64,
    },
    /// The move was marked as complete by `finish`.
    #[error(
        "the move is complete, so no segment can be added after finish(); retarget the move, or wait for its \
         end"
    )]
    Finished,
    /// The motor was stopped, or the queue ran dry. The plan no longer holds.
    #[error(
        "the motor was stopped, so the plan no longer holds; call clear() and plan anew from the position"
    )]
    Stopped,
}

/// The refusal to start a move. The executor is unchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StartError {
    /// No segment is queued.
    #[error("no segment is queued; push the plan's segments first")]
    Empty,
    /// A move is under way.
    #[error("a move is under way; wait for its end or stop it")]
    Moving,
    /// The motor was stopped, or the queue ran dry. The plan no longer holds.
    #[error(
        "the motor was stopped, so the plan no longer holds; call clear() and plan anew from the position"
    )]
    Stopped,
}
