//! The errors of a refit.

use thiserror::Error;

/// Error of a refit.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum RefitError {
    /// The clock of the board is too slow.
    #[error(
        "the board's clock makes {hz} ticks a second, and {slowest_hz} are needed at least; use another board"
    )]
    Clock {
        /// Ticks of a second.
        hz: u32,
        /// Ticks of a second of the slowest clock.
        slowest_hz: u32,
    },
    /// The shortest interval is out of range.
    #[error("the shortest interval of the board's steps is {ticks} ticks, and 1 to {longest} are allowed")]
    Shortest {
        /// Interval, in ticks.
        ticks: u32,
        /// Longest interval, in ticks.
        longest: u32,
    },
    /// Two steps are closer than the board makes them.
    #[error(
        "step {step} comes {ticks:.0} ticks of the board's clock after the step before it, and the board needs \
         {shortest} at least; choose a lower flow, fewer microsteps or a faster board"
    )]
    Fast {
        /// Number of the step, from 1.
        step: u64,
        /// Time from the step before, as the board has made it, in ticks.
        ticks: f64,
        /// Shortest interval of the board, in ticks.
        shortest: u32,
    },
    /// The time of a step is no time, is before that of the step before it, or is beyond 2^52 ticks.
    #[error(
        "step {step} is due {time_s} s after the start, and the step before it {before_s:.6} s; the times of steps \
         must rise, up to {latest_s:.0} s on this board"
    )]
    Time {
        /// Number of the step, from 1.
        step: u64,
        /// Time of the step, in s.
        time_s: f64,
        /// Time of the step before, in s.
        before_s: f64,
        /// Latest time that can be told to a tick, in s.
        latest_s: f64,
    },
}
