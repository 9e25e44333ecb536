//! The computer's own clock, in ticks.

use std::time::Instant;

use pump_ctl::drive::Clock;
use pump_ctl::step::TickRate;

/// Clock of the computer, which never falls.
///
/// ```
/// use pump_bench::drives::MonotonicClock;
/// use pump_ctl::drive::Clock;
/// use pump_ctl::step::TickRate;
///
/// let mut clock = MonotonicClock::new(TickRate::from_hz(1_000_000).unwrap());
/// assert!(clock.now() <= clock.now());
/// ```
#[derive(Debug, Clone, Copy)]
pub struct MonotonicClock {
    began: Instant,
    tick_rate: TickRate,
}

impl MonotonicClock {
    /// Starts a clock at tick 0.
    pub fn new(tick_rate: TickRate) -> Self {
        Self { began: Instant::now(), tick_rate }
    }

    /// Returns the ticks in a second.
    pub fn tick_rate(&self) -> TickRate {
        self.tick_rate
    }
}

impl Clock for MonotonicClock {
    fn now(&mut self) -> u64 {
        let ticks = self.began.elapsed().as_nanos() * u128::from(self.tick_rate.hz()) / 1_000_000_000;
        u64::try_from(ticks).unwrap_or(u64::MAX)
    }
}
