//! `[safety]`: limits that keep a pump safe while nobody looks.

use serde::{Deserialize, Serialize};

use crate::pump_file::range::{WrongValue, positive};
use crate::words::words;

/// Choice of what a dose without a person does once the angle of the rollers was disturbed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HomePolicy {
    /// The rotor turns to its index sensor first.
    Sensor,
    /// The dose is refused.
    Refuse,
    /// The dose is made from the angle as it is known, and says how far its volume may be off.
    Accept,
}

words!(HomePolicy { Sensor = "sensor", Refuse = "refuse", Accept = "accept" });

/// The table `[safety]`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct SafetyTable {
    /// Most volume in any 24 hours, in mL, in either direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_ml_per_day: Option<f64>,
    /// Volume that the receiving vessel holds, in mL.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vessel_ml: Option<f64>,
    /// Choice of what a dose without a person does once the angle was disturbed. `None` doses from the angle as it is
    /// known, with a warning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub home: Option<HomePolicy>,
}

impl SafetyTable {
    /// Returns true if the table says nothing.
    pub(in crate::pump_file) fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Refuses volumes that are no limits.
    pub(in crate::pump_file) fn check(&self) -> Result<(), WrongValue> {
        let given = |key, value: Option<f64>| value.map_or(Ok(()), |value| positive(key, value));
        given("[safety] max_ml_per_day", self.max_ml_per_day)?;
        given("[safety] vessel_ml", self.vessel_ml)
    }
}
