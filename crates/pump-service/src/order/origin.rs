//! Those who give orders.

use std::fmt::{self, Display, Formatter};

/// Giver of an order, as the history keeps it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// A program or the page, over HTTP.
    Http,
    /// The command on this machine.
    Command,
    /// A message of the MQTT broker.
    Mqtt,
    /// An entry of the schedule, by its name.
    Schedule(String),
    /// The guard.
    Guard,
}

impl Display for Origin {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Http => to.write_str("http"),
            Self::Command => to.write_str("command"),
            Self::Mqtt => to.write_str("mqtt"),
            Self::Guard => to.write_str("guard"),
            Self::Schedule(entry) => write!(to, "schedule {entry}"),
        }
    }
}
