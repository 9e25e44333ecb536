//! Those who give orders.

use std::fmt::{self, Display, Formatter};

/// Giver of an order, as the history keeps it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// A program, over HTTP. Orders of earlier versions may be the page's.
    Http,
    /// A person at the page.
    Page,
    /// The command on this machine.
    Command,
    /// A message of the MQTT broker.
    Mqtt,
    /// An entry of the schedule, by its name.
    Schedule(String),
    /// The guard.
    Guard,
}

impl Origin {
    /// Returns true for a giver who hears what was refused: nobody else needs to be told.
    pub(crate) fn is_answered(&self) -> bool {
        matches!(self, Self::Http | Self::Page)
    }
}

impl Display for Origin {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Http => to.write_str("http"),
            Self::Page => to.write_str("page"),
            Self::Command => to.write_str("command"),
            Self::Mqtt => to.write_str("mqtt"),
            Self::Guard => to.write_str("guard"),
            Self::Schedule(entry) => write!(to, "schedule {entry}"),
        }
    }
}
