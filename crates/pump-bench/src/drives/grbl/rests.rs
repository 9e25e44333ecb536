//! The rests of a motor before the end of its motion: it had made all the jogs that it had.
//!
//! The next jog may be late because it has no leave yet, or because this program did not get to run. A motor without
//! current at rest may have fallen then, so no rest may be missed.

use std::time::Duration;

use super::reply::BoardState;

/// Longest time from a report to the line that was sent with its question.
const LATENCY: Duration = Duration::from_millis(20);

/// Rests of a motor in one motion.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rests {
    count: u32,
    /// Step of the last rest.
    at: u64,
}

impl Rests {
    pub(super) fn count(self) -> u32 {
        self.count
    }

    /// Takes in a report of a motor that has made `made` steps, and moves at `steps_s` at most. While a line is on its
    /// way to the board, the lines before it end at step `end`.
    ///
    /// The report tells a rest, or a motor that may come to rest before that line: it needs at least the time of the
    /// cruise for the steps that are left.
    pub(super) fn note(&mut self, state: &BoardState, made: u64, end: Option<u64>, steps_s: f64) {
        let may_rest = |end: &u64| made <= *end && (*end - made) as f64 <= steps_s * LATENCY.as_secs_f64();
        let rested = match state {
            BoardState::Idle => Some(made),
            BoardState::Jog => end.filter(may_rest),
            _ => None,
        };
        if let Some(at) = rested.filter(|at| *at > self.at) {
            self.at = at;
            self.count += 1;
        }
    }
}
