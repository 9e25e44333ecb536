//! Refusals of the executor.

use thiserror::Error;

use super::segment::Segment;

/// A segment that is not taken. Nothing has changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PushError {
    /// The queue has no room now: push again when a segment has been used up.
    #[error("the queue of segments is full; push again when one has been used up")]
    Full,
    /// No steps, or an interval shorter than one tick or longer than 2^48.
    #[error(
        "{0:?} has no steps, or an interval below 1 tick or above 2^48; use a faster timer or a slower \
         dose, or a slower timer"
    )]
    Segment(Segment),
    /// The move was marked as complete by `finish`.
    #[error("the move is complete: nothing can be added after finish(); retarget it, or wait for its end")]
    Finished,
    /// The motor was stopped, or the queue ran dry: what was planned no longer holds.
    #[error(
        "the motor was stopped, so what was planned no longer holds; clear() and plan anew from the position"
    )]
    Stopped,
}

/// A move that does not start. Nothing has changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StartError {
    /// No segment is queued.
    #[error("no segment is queued; push the plan's segments first")]
    Empty,
    /// A move is under way.
    #[error("a move is under way; wait for its end or stop it")]
    Moving,
    /// The motor was stopped, or the queue ran dry.
    #[error(
        "the motor was stopped, so what was planned no longer holds; clear() and plan anew from the position"
    )]
    Stopped,
}
