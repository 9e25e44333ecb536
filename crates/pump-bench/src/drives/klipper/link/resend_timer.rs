//! The time after which a block that is not confirmed is sent again.

use std::time::Duration;

/// Shortest time. A line of 115,200 baud takes 17 ms for the 192 bytes that a board's buffer holds.
const LEAST: Duration = Duration::from_millis(25);

/// Longest time. Longer pauses would only delay the word that the link is lost.
const MOST: Duration = Duration::from_millis(500);

/// Time before any confirmation was seen.
const FIRST: Duration = Duration::from_millis(200);

/// Time after which a block is sent again, by the delays of its forerunners.
///
/// Source: RFC 6298, sections 2 and 5, with bounds of our own.
#[derive(Debug, Clone)]
pub(super) struct ResendTimer {
    /// Smoothed delay and its smoothed deviation.
    delay: Option<(Duration, Duration)>,
    /// Number of times that the wait was doubled.
    doublings: u32,
}

impl ResendTimer {
    pub(super) fn new() -> Self {
        Self { delay: None, doublings: 0 }
    }

    /// Takes the delay between a block that was sent once and its confirmation, which ends the doubling. Nobody knows
    /// which sending of a repeated block was confirmed, so its delay says nothing.
    pub(super) fn take(&mut self, delay: Duration) {
        self.delay = Some(match self.delay {
            None => (delay, delay / 2),
            Some((smooth, deviation)) => {
                ((smooth * 7 + delay) / 8, (deviation * 3 + smooth.abs_diff(delay)) / 4)
            }
        });
        self.doublings = 0;
    }

    /// Doubles the wait, because a block was not confirmed within it.
    pub(super) fn double(&mut self) {
        self.doublings = (self.doublings + 1).min(8);
    }

    /// Returns the time to wait for a confirmation, in whole milliseconds: a clock may know no less than a microsecond.
    pub(super) fn wait(&self) -> Duration {
        let wait = self.delay.map_or(FIRST, |(smooth, deviation)| smooth.saturating_add(deviation * 4));
        let wait = (wait.clamp(LEAST, MOST) * (1 << self.doublings)).min(MOST);
        Duration::from_millis(wait.as_millis() as u64)
    }
}
