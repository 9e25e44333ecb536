//! The way to rest that a motor is on.

use super::brake::{Brake, Descent};
use super::final_ramp::FinalRamp;
use crate::step::segment::Segment;

/// The way to rest that a motor is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::step) enum WayDown {
    /// Down the brake.
    Brake(Descent),
    /// In the steps that are left to the end of the plan, which are fewer than those of the brake.
    ToEnd(FinalRamp),
}

impl WayDown {
    /// Returns the way to rest in `left` steps, or `None` of no steps. The last interval was `interval`, 2^-32 tick.
    pub(in crate::step) fn to_end(interval: i128, left: u32) -> Option<Self> {
        (left > 0).then(|| Self::ToEnd(FinalRamp::new(interval, left)))
    }

    /// Returns the steps of the way and its time, 2^-32 tick.
    pub(in crate::step) fn length(&self, brake: &Brake) -> (u32, i128) {
        match self {
            Self::Brake(descent) => brake.length(descent),
            Self::ToEnd(ramp) => ramp.length(),
        }
    }

    /// Returns the next segment of the way. It slows down and has a positive count.
    pub(in crate::step) fn next_down(&mut self, brake: &Brake) -> Option<Segment> {
        match self {
            Self::Brake(descent) => brake.next_down(descent),
            Self::ToEnd(ramp) => ramp.next_down(),
        }
    }
}
