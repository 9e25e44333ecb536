//! The purpose of a motion.

use serde::{Deserialize, Serialize};

use crate::words::words;

/// Purpose of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Purpose {
    /// A dose into the vessel. It settles the carry of earlier doses.
    Dose,
    /// Filling of the line before a dose. It neither uses nor changes the carry.
    Prime,
    /// Emptying of the line. It neither uses nor changes the carry.
    Purge,
    /// A run of continuous flow. It neither uses nor changes the carry.
    Run,
    /// A run that is weighed for a calibration. It uses the model without calibration and speed law, and
    /// neither uses nor changes the carry.
    Calibrate,
    /// A retraction after a dose. The next dose carries its volume.
    Retract,
    /// A turn of the rotor to a mark, or to the index. It neither uses nor changes the carry.
    Jog,
}

words!(Purpose {
    Dose = "dose",
    Prime = "prime",
    Purge = "purge",
    Run = "run",
    Calibrate = "calibrate",
    Retract = "retract",
    Jog = "jog",
});

impl Purpose {
    /// Returns true if a motion of this purpose changes the carry.
    pub(crate) fn changes_carry(self) -> bool {
        matches!(self, Self::Dose | Self::Retract)
    }

    /// Returns true if a cut-off motion of this purpose is to be resumed or accepted.
    pub(crate) fn is_delivery(self) -> bool {
        !matches!(self, Self::Calibrate | Self::Retract | Self::Jog)
    }
}
