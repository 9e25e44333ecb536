//! Scatter of the runs, with its degrees of freedom.

use std::num::NonZeroU32;

/// Scatter of the runs that a calibration rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scatter {
    /// No degree of freedom is left, so the standard errors are those that were expected.
    Expected,
    /// The runs show their scatter.
    Seen {
        /// Degrees of freedom: runs less speeds where speeds were repeated, else runs less parameters.
        degrees_of_freedom: NonZeroU32,
        /// Standard deviation of the runs at one speed, as a part of the volume; where none was repeated,
        /// that about the line or law.
        standard: f64,
    },
}

impl Scatter {
    /// Returns the degrees of freedom; 0 if the scatter was expected and not seen.
    pub fn degrees_of_freedom(&self) -> u32 {
        match self {
            Self::Expected => 0,
            Self::Seen { degrees_of_freedom, .. } => degrees_of_freedom.get(),
        }
    }

    /// Returns the standard deviation of the runs, as a part of the volume, if they show it.
    pub fn standard(&self) -> Option<f64> {
        match self {
            Self::Expected => None,
            Self::Seen { standard, .. } => Some(*standard),
        }
    }
}
