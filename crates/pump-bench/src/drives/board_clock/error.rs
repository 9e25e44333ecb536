//! Clocks that cannot be followed.

use thiserror::Error;

/// Clock of a board that cannot be followed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ClockError {
    /// The clock of the board or of the computer jumped.
    #[error(
        "the clock of the board or of this computer has jumped: the board's is {:.3} ms {} than it could be by this \
         computer's; it is read anew before anything moves again",
        by_ms.abs(), if *by_ms < 0.0 { "earlier" } else { "later" }
    )]
    Jump {
        /// Least distance of the clock from where it could be, in ms. Positive if the clock is later.
        by_ms: f64,
        /// Uncertainty of the place where the clock was expected, in ms.
        within_ms: f64,
    },
    /// The answer came before its question.
    #[error("the board's clock was read for a time of {took_s} s, which is none; read it anew")]
    Order {
        /// Time from question to answer, in s.
        took_s: f64,
    },
    /// The clock was read too long ago.
    #[error(
        "the board's clock was last read {ago_s:.0} s ago and is known to within {within_s:.1} s, too little to count \
         its turns; ask the board how long it has been running"
    )]
    Stale {
        /// Time since the last reading, in s.
        ago_s: f64,
        /// Uncertainty of the clock now, in s.
        within_s: f64,
    },
}
