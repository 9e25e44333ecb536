//! The pace of a rack whose motors are simulated.

use crate::words::words;

/// Pace of a rack. Real motors keep real time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RackPace {
    /// Simulated motors take the time of their plans.
    #[default]
    Real,
    /// Simulated motors take no time. They keep step with each other.
    Fast,
}

words!(RackPace { Real = "real", Fast = "fast" });
