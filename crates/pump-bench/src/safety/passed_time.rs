//! The time that has surely passed, by wall times in the order of the record.

use serde::{Deserialize, Serialize};

use crate::numbers::duration;

/// Time that has surely passed since the first wall time on record, in s, never more than has passed unless the clock
/// was set forward.
///
/// A clock that jumps back takes nothing away and adds nothing. A clock that jumps forward again, as one that is set
/// from the network after a start in 1970, adds only what lies beyond the latest time that was ever seen. A clock that
/// stays behind goes on to count from there. Nobody can tell a clock that is set forward from time that passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PassedTime {
    /// Time that has surely passed, in s.
    pub(crate) passed_s: u64,
    /// Wall time that was seen last, in seconds since 1970.
    pub(super) last_s: u64,
    /// Latest wall time that was ever seen, in seconds since 1970.
    pub(super) latest_s: u64,
    /// Time that had passed when the latest wall time was seen, in s.
    at_latest_s: u64,
}

/// Returns words for a clock that is so far behind the record, in s.
pub(crate) fn clock_behind(behind_s: u64) -> String {
    let behind = duration(behind_s as f64);
    format!(
        "the clock is {behind} behind the latest time on record: it was set back, which frees no volume of the last \
         24 h"
    )
}

impl PassedTime {
    /// Begins with the wall time `now_s`.
    pub(super) fn from(now_s: u64) -> Self {
        Self { passed_s: 0, last_s: now_s, latest_s: now_s, at_latest_s: 0 }
    }

    /// Returns the time once the clock shows `now_s`.
    pub(super) fn seen(self, now_s: u64) -> Self {
        if now_s < self.latest_s {
            let passed_s = self.passed_s.saturating_add(now_s.saturating_sub(self.last_s));
            return Self { passed_s, last_s: now_s, ..self };
        }
        let beyond_s = self.at_latest_s.saturating_add(now_s - self.latest_s);
        let passed_s = self.passed_s.max(beyond_s);
        Self { passed_s, last_s: now_s, latest_s: now_s, at_latest_s: passed_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOUR: u64 = 3600;

    /// The hours that have passed after each of these hours of the clock.
    fn passed_h(clock_h: &[u64]) -> Vec<u64> {
        let mut time = PassedTime::from(clock_h[0] * HOUR);
        clock_h
            .iter()
            .map(|hour| {
                time = time.seen(hour * HOUR);
                time.passed_s / HOUR
            })
            .collect()
    }

    #[test]
    fn a_clock_that_goes_right_counts_every_hour() {
        assert_eq!(passed_h(&[100, 101, 101, 150]), [0, 1, 1, 50]);
    }

    #[test]
    fn a_clock_that_starts_in_1970_and_is_set_right_counts_what_passed_and_no_more() {
        // One hour in 1970, then the network sets the clock: three hours since the first time in all.
        assert_eq!(passed_h(&[100, 0, 1, 103]), [0, 0, 1, 3]);
        // Time that passed in 1970 is not counted a second time.
        assert_eq!(passed_h(&[100, 0, 5, 101]), [0, 0, 5, 5]);
    }

    #[test]
    fn a_clock_that_is_set_back_for_good_goes_on_from_there() {
        assert_eq!(passed_h(&[100, 50, 60, 74, 99, 101]), [0, 0, 10, 24, 49, 49]);
    }

    #[test]
    fn no_clock_turns_the_time_back() {
        let mut time = PassedTime::from(7);
        for now_s in [u64::MAX, 0, 3, u64::MAX - 1, u64::MAX, 0, u64::MAX] {
            let after = time.seen(now_s);
            assert!(after.passed_s >= time.passed_s);
            time = after;
        }
    }
}
