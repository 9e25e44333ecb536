//! Why the pump turns.

use serde::{Deserialize, Serialize};

use crate::words::words;

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

words!(Purpose {
    Dose = "dose",
    Prime = "prime",
    Purge = "purge",
    Calibrate = "calibrate",
    Retract = "retract",
    Jog = "jog",
});

impl Purpose {
    /// Whether what is cut off of it is to be resumed or discarded.
    pub fn is_delivery(self) -> bool {
        !matches!(self, Self::Calibrate | Self::Retract | Self::Jog)
    }
}
