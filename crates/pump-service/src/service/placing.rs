//! An order that is taken, or refused.

use serde_json::Value;
use thiserror::Error;

use crate::history::{HistoryError, OrderRecord};
use crate::order::OrderError;
use crate::worker::error_report;

/// Order that was taken. It runs, or has ended already.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// The order as it stands.
    pub record: OrderRecord,
    /// True if the key was used before, so that nothing new was begun.
    pub repeated: bool,
}

/// Order that was not taken. Nothing has moved.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The configuration has no such pump.
    #[error("there is no pump `{name}`; the configuration names {known}")]
    UnknownPump {
        /// Name that was given.
        name: String,
        /// Names of the configuration.
        known: String,
    },
    /// The pump carries out another order.
    #[error("pump {pump} is {doing} (by {origin}); wait until it is done, or stop it")]
    Busy {
        /// Name of the pump.
        pump: String,
        /// Task that it carries out, as `dosing 25 mL`.
        doing: String,
        /// Giver of the order that it carries out.
        origin: String,
    },
    /// The guard has the pump stand.
    #[error("pump {pump} does not move: {reason}")]
    Guarded {
        /// Name of the pump.
        pump: String,
        /// Input that is not well, what it says, and what to do.
        reason: String,
    },
    /// The pump is not cleared: an input of it is not well.
    #[error("{fault}; pump {pump} stands until it is")]
    NotWell {
        /// Name of the pump.
        pump: String,
        /// Input, and what it says.
        fault: String,
    },
    /// The order cannot be put into words of the command.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// The key stands for another order.
    #[error(
        "the key `{key}` belongs to another order of the last 24 hours; give each order a key of its own"
    )]
    KeyReused {
        /// Key that was given.
        key: String,
    },
    /// The key is empty or too long.
    #[error("the key is {0} bytes long; 1 to 200 are allowed")]
    Key(usize),
    /// The service ends.
    #[error("the service is ending; nothing begins any more")]
    Ending,
    /// The order cannot be recorded, so it is not carried out.
    #[error("{0}; the order was not begun")]
    History(#[from] HistoryError),
    /// The command cannot be started.
    #[error("the command cannot be started: {0}; the order was not begun")]
    Start(std::io::Error),
    /// The system has no random numbers.
    #[error("the system has no random numbers: {0}; the order was not begun")]
    Random(#[from] getrandom::Error),
}

impl Refusal {
    /// Returns the exit code that the command would have: 2 refused, 3 in use, 5 the pump stands.
    pub fn code(&self) -> u8 {
        match self {
            Self::Busy { .. } => 3,
            Self::Guarded { .. } | Self::NotWell { .. } => 5,
            _ => 2,
        }
    }

    /// Returns the word of the kind, as in `error/1`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::UnknownPump { .. } => "pump",
            Self::Busy { .. } => "busy",
            Self::Guarded { .. } | Self::NotWell { .. } => "safety",
            Self::Order(_) | Self::Key(_) => "usage",
            Self::KeyReused { .. } => "key",
            Self::Ending => "stopped",
            Self::History(_) => "record",
            Self::Start(_) | Self::Random(_) => "service",
        }
    }

    /// Returns the refusal as `error/1`.
    pub fn report(&self) -> Value {
        error_report(self.code(), self.kind(), &self.to_string())
    }
}
