//! The dead-man timer: how long ago the host was heard.

use crate::message::{DEAD_MAN_MS, LONGEST_DEAD_MAN_MS, SHORTEST_DEAD_MAN_MS};

/// The dead-man timer, which a host feeds with valid frames.
///
/// ```
/// use pump_link::receiver::DeadMan;
///
/// let mut dead_man = DeadMan::new(1_000_000);
/// assert!(dead_man.set_ms(100));
/// dead_man.fed(5_000);
/// assert!(!dead_man.is_over(104_999));
/// assert!(dead_man.is_over(105_000));
/// assert!(!dead_man.set_ms(99));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct DeadMan {
    tick_hz: u32,
    /// Dead-man time, ticks.
    limit: u64,
    fed_at: u64,
}

impl DeadMan {
    /// Makes a timer of [`DEAD_MAN_MS`] for ticks of this rate.
    pub fn new(tick_hz: u32) -> Self {
        Self { tick_hz, limit: ticks(tick_hz, DEAD_MAN_MS), fed_at: 0 }
    }

    /// Sets the dead-man time, ms. Returns false, and changes nothing, if the time is out of range.
    #[must_use]
    pub fn set_ms(&mut self, ms: u16) -> bool {
        let allowed = (SHORTEST_DEAD_MAN_MS..=LONGEST_DEAD_MAN_MS).contains(&ms);
        if allowed {
            self.limit = ticks(self.tick_hz, ms);
        }
        allowed
    }

    /// Notes a valid frame at tick `now`.
    pub fn fed(&mut self, now: u64) {
        self.fed_at = now;
    }

    /// Returns true if the dead-man time has passed without a valid frame.
    pub fn is_over(&self, now: u64) -> bool {
        now.saturating_sub(self.fed_at) >= self.limit
    }
}

fn ticks(hz: u32, ms: u16) -> u64 {
    u64::from(hz) * u64::from(ms) / 1000
}
