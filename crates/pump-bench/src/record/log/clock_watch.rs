//! Jumps of a clock, seen beside one that does not jump.

use std::fmt;
use std::time::Instant;

use super::{Clock, SystemClock};
use crate::numbers::duration;

/// Least jump that is told, in s. A time server that slews a clock stays below it.
const LEAST_S: f64 = 5.0;

/// Part of the time between two looks by which a clock may be slewed: the kernel slews by 500 ppm at most, and a
/// crystal errs by 100 ppm.
const SLEWED: f64 = 1e-3;

/// Jump of the computer's clock: it was set, or the computer slept.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ClockJump {
    /// Time by which the clock went ahead, in s; negative if it went back.
    pub ahead_s: f64,
}

impl fmt::Display for ClockJump {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let by = duration(self.ahead_s.abs());
        if self.ahead_s < 0.0 {
            return write!(to, "the computer's clock went back by {by}: somebody set it");
        }
        write!(to, "the computer's clock went ahead by {by}: somebody set it, or the computer slept")
    }
}

/// Watch over the computer's clock beside one that only goes forward, and on most systems stands still in sleep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockWatch {
    began: Instant,
    /// Times of the last look by the two clocks, in s.
    last: (f64, f64),
}

impl ClockWatch {
    /// Begins to watch the computer's clock.
    #[must_use]
    pub fn of_system() -> Self {
        Self { began: Instant::now(), last: (SystemClock.now().unix_s as f64, 0.0) }
    }

    /// Returns the jump of the clock since the last look. `None` if it went as it should.
    pub fn look(&mut self) -> Option<ClockJump> {
        self.seen(SystemClock.now().unix_s as f64, self.began.elapsed().as_secs_f64())
    }

    /// Returns the jump of a clock that shows `unix_s`, while one that does not jump shows `steady_s`.
    fn seen(&mut self, unix_s: f64, steady_s: f64) -> Option<ClockJump> {
        let (unix_before_s, steady_before_s) = std::mem::replace(&mut self.last, (unix_s, steady_s));
        let passed_s = steady_s - steady_before_s;
        let ahead_s = unix_s - unix_before_s - passed_s;
        (ahead_s.abs() > LEAST_S + SLEWED * passed_s).then_some(ClockJump { ahead_s })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_told_once_and_a_slewed_clock_is_none() {
        let mut watch = ClockWatch { began: Instant::now(), last: (1_795_400_100.0, 0.0) };
        // An hour by both clocks, with all that a time server may slew.
        assert_eq!(watch.seen(1_795_403_701.0, 3600.0), None);
        // 27 hours back, as where a battery is empty, and then as before.
        let back = watch.seen(1_795_306_511.0, 3610.0).unwrap();
        assert_eq!(back.to_string(), "the computer's clock went back by 27 h: somebody set it");
        assert_eq!(watch.seen(1_795_306_521.0, 3620.0), None);
        let ahead = watch.seen(1_795_306_531.0 + 7200.0, 3630.0).unwrap();
        assert_eq!(
            ahead.to_string(),
            "the computer's clock went ahead by 2 h: somebody set it, or the computer slept"
        );
        assert_eq!(watch.seen(1_795_306_541.0 + 7203.0, 3640.0), None, "the seconds of a stamp are whole");
    }
}
