//! The pulses of an axis's step pin.

use super::setup::Times;
use crate::board::Edge;

/// Pulses of an axis's step pin, one for each step.
#[derive(Debug, Default)]
pub(super) struct Pulse {
    /// Tick after which the pin is still low, or inactive, for as long as the driver needs.
    pub(super) low_until: u64,
    /// Tick at which the pin was seen high, or active. `None` between pulses.
    pub(super) high_since: Option<u64>,
    pub(super) begin: Edge,
    pub(super) end: Edge,
    /// Ticks for which the pin is high, and low.
    high: u64,
    low: u64,
}

impl Pulse {
    /// Makes the pulses of a step pin, which is a bit of the board's outputs.
    pub(super) fn new(pin: u32, active_low: bool, times: &Times) -> Self {
        Self {
            low_until: 0,
            high_since: None,
            begin: Edge::of(pin, !active_low),
            end: Edge::of(pin, active_low),
            high: times.high,
            low: times.low,
        }
    }

    /// Returns the tick at which the pulse that is under way may end.
    pub(super) fn ends_at(&self) -> Option<u64> {
        Some(self.high_since? + self.high)
    }

    /// Notes that the pulse has ended by tick `now`.
    pub(super) fn ended(&mut self, now: u64) {
        self.high_since = None;
        self.low_until = now + self.low;
    }
}
