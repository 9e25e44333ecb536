//! Why the pump turns.

use serde::{Deserialize, Serialize};

/// Why the pump is to turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Purpose {
    /// A dose into the vessel; earlier doses' carry is settled with it.
    Dose,
    /// Filling the line before a dose; owes nothing and repays nothing.
    Prime,
    /// Emptying the line; owes nothing and repays nothing.
    Purge,
    /// A run that is weighed for a calibration: of the model without calibration and speed law, owing and repaying nothing.
    Calibrate,
    /// Sucking back after a dose; the next dose owes as much more.
    Retract,
    /// Turning the rotor to a mark, or on to the index; owes nothing and repays nothing.
    Jog,
}

impl Purpose {
    /// In reports and in the journal.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Dose => "dose",
            Self::Prime => "prime",
            Self::Purge => "purge",
            Self::Calibrate => "calibrate",
            Self::Retract => "retract",
            Self::Jog => "jog",
        }
    }

    /// Whether what is cut off of it is to be resumed or discarded.
    pub fn is_delivery(self) -> bool {
        !matches!(self, Self::Calibrate | Self::Retract | Self::Jog)
    }
}
