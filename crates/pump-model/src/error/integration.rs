//! Why an integration stops before its end.

use thiserror::Error;

/// Why an integration stopped.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum IntegrationError {
    /// The state or its derivative is not a finite number.
    #[error("the state is not finite at t = {time_s} s")]
    NotFinite {
        /// Time at which the state is not finite, s.
        time_s: f64,
    },
    /// The tolerance cannot be met by any step.
    #[error("the step size underflows at t = {time_s} s; loosen the tolerance")]
    StepUnderflow {
        /// Time at which no step meets the tolerance, s.
        time_s: f64,
    },
    /// A tolerance that no method can meet.
    #[error("integration tolerance {tolerance:e}; allowed: 1e-13 to 0.1")]
    Tolerance {
        /// The tolerance that was asked for.
        tolerance: f64,
    },
}
