//! Refusals of the executor.

use pump_model::Allowed;
use thiserror::Error;

use crate::parameter::Parameter;

use super::segment::Segment;
use super::tick_rate::TickRate;

/// The refusal of a brake. A motor without a brake would stop dead from full speed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum BrakeError {
    /// There is no segment.
    #[error("a brake of no segments would stop a motor dead; give it at least one that speeds up from rest")]
    Empty,
    /// There are more segments than a brake has entries.
    #[error("a brake has at most {} segments; join some of them", super::BRAKE_ENTRIES)]
    TooMany,
    /// A segment does not speed up, or cannot be made.
    #[error(
        "segment {number} of the brake is {segment:?}; allowed: segments that go forward and never slow down, \
         with intervals of 1 to 2^48 ticks"
    )]
    Segment {
        /// Number of the segment, 1 for the first.
        number: usize,
        /// Segment as it was given.
        segment: Segment,
    },
    /// A value of the motor is out of range.
    #[error("{parameter} is {value}; allowed: {allowed}")]
    OutOfRange {
        /// Name of the value.
        parameter: Parameter,
        /// Value as it was given.
        value: f64,
        /// Range that is allowed.
        allowed: Allowed,
    },
    /// The motor's first steps come less than a tick apart.
    #[error("the motor's first step from rest takes less than a tick at {tick_rate}; use a faster timer")]
    SlowTimer {
        /// Rate of the timer.
        tick_rate: TickRate,
    },
}

/// The refusal of a segment. The executor is unchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
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
