//! Reasons why the service cannot talk to a broker at all.

use thiserror::Error;

use crate::history::HistoryError;

/// Broker that the service cannot talk to. One that does not answer is none of these.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MqttError {
    /// The address is none.
    #[error("the MQTT broker is `{0}`; allowed: a host and a port, as localhost:1883")]
    Broker(String),
    /// The client id cannot be kept.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// The system has no random numbers.
    #[error("the system has no random numbers: {0}")]
    Random(#[from] getrandom::Error),
}
