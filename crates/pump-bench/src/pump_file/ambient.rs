//! `[ambient]`: the surroundings of the pump.

use serde::{Deserialize, Serialize};

use super::range::{WrongValue, within};

/// The table `[ambient]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct AmbientTable {
    /// Atmospheric pressure, in kPa absolute. Gauge pressures are measured against it.
    pub pressure_kpa: f64,
}

impl AmbientTable {
    /// Refuses an atmospheric pressure outside 1 to 10000 kPa.
    pub(super) fn check(&self) -> Result<(), WrongValue> {
        within("[ambient] pressure_kpa", self.pressure_kpa, 1.0..=1e4)
    }
}
