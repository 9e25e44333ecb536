//! The clock of the board: ticks since it was switched on.

use std::time::{Duration, Instant};

/// Clock that runs from an instant on, a little too fast or too slow.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    begun: Instant,
    first: u64,
    ticks_s: f64,
}

impl Clock {
    pub(super) fn new(hz: u32, drift_ppm: f64, first: u64) -> Self {
        Self { begun: Instant::now(), first, ticks_s: f64::from(hz) * (1.0 + drift_ppm * 1e-6) }
    }

    /// Returns the tick now.
    pub(super) fn now(&self) -> u64 {
        self.first + (self.begun.elapsed().as_secs_f64() * self.ticks_s) as u64
    }

    /// Returns the instant at which the clock stands at a tick.
    pub(super) fn instant_of(&self, tick: u64) -> Instant {
        self.begun + self.time(tick.saturating_sub(self.first))
    }

    /// Lets the clock jump by so many ticks.
    pub(super) fn jump(&mut self, ticks: u64) {
        self.first += ticks;
    }

    /// Returns the ticks of a time.
    pub(super) fn ticks(&self, time: Duration) -> u64 {
        (time.as_secs_f64() * self.ticks_s) as u64
    }

    /// Returns the time of some ticks.
    pub(super) fn time(&self, ticks: u64) -> Duration {
        Duration::from_secs_f64(ticks as f64 / self.ticks_s)
    }
}
