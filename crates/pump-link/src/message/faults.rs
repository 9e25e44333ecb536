//! Faults, counted.

use serde::{Deserialize, Serialize};

/// Numbers of faults of an axis, kind by kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct FaultCounts {
    /// Moves that ended because a step came when the next one was due already.
    pub late: u32,
    /// Moves that ended because the queue of segments ran dry.
    pub starved: u32,
    /// Faults that the stepper driver reported.
    pub driver: u32,
    /// Moves that ended because no valid frame came within the dead-man time.
    pub link: u32,
    /// Presses of the emergency stop.
    pub estop: u32,
}

impl FaultCounts {
    /// Returns the counts of both, kind by kind, by `with`.
    fn zip(self, other: Self, with: impl Fn(u32, u32) -> u32) -> Self {
        Self {
            late: with(self.late, other.late),
            starved: with(self.starved, other.starved),
            driver: with(self.driver, other.driver),
            link: with(self.link, other.link),
            estop: with(self.estop, other.estop),
        }
    }

    /// Returns what these counts have beyond `other`.
    #[must_use]
    pub fn beyond(self, other: Self) -> Self {
        self.zip(other, u32::saturating_sub)
    }

    /// Returns the larger count of each kind.
    #[must_use]
    pub fn largest(self, other: Self) -> Self {
        self.zip(other, u32::max)
    }

    /// Returns the smaller count of each kind.
    #[must_use]
    pub fn smallest(self, other: Self) -> Self {
        self.zip(other, u32::min)
    }

    /// Returns true if no fault is counted.
    pub fn is_empty(self) -> bool {
        self == Self::default()
    }
}
