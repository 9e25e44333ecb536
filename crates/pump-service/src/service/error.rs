//! Reasons why a service cannot begin.

use thiserror::Error;

use crate::history::HistoryError;

/// Service that cannot begin.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ServiceError {
    /// A pump of the configuration cannot be used.
    #[error("pump {name}: {message}")]
    Pump {
        /// Name of the pump in the configuration.
        name: String,
        /// Fault and way out, in words.
        message: String,
    },
    /// The history cannot be used.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// The system has no random numbers.
    #[error("the system has no random numbers: {0}")]
    Random(#[from] getrandom::Error),
}
