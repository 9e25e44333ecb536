//! Refusals of a brake.

use pump_model::{Allowed, Shown};
use thiserror::Error;

use super::brake::BRAKE_ENTRIES;
use crate::parameter::Parameter;
use crate::step::segment::Segment;
use crate::step::tick_rate::TickRate;

/// The refusal of a brake. A motor without a brake would stop dead from full speed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum BrakeError {
    /// There is no segment.
    #[error("a brake of no segments would stop a motor dead; give it at least one that speeds up from rest")]
    Empty,
    /// There are more segments than a brake has entries.
    #[error("a brake has at most {} segments; join some of them", BRAKE_ENTRIES)]
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
    #[error("{parameter} is {}; allowed: {allowed}", Shown(*value))]
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
