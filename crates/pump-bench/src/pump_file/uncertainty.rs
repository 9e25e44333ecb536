//! `[uncertainty]`: how far to trust the model of the pump.

use serde::{Deserialize, Serialize};

use super::range::{WrongValue, within};

/// The table `[uncertainty]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct UncertaintyTable {
    /// Standard uncertainty of the model's volume, in percent of the volume.
    pub model_percent: f64,
    /// Standard deviation of repeated doses, in percent of the volume.
    pub repeatability_percent: f64,
    /// Standard uncertainty of the volume of one roller, in mL. It dominates a dose within a single pulse.
    pub roller_volume_ml: f64,
}

impl UncertaintyTable {
    /// Refuses the first uncertainty outside its range.
    pub(super) fn check(&self) -> Result<(), WrongValue> {
        within("[uncertainty] model_percent", self.model_percent, 0.0..=100.0)
            .map_err(|wrong| wrong.hint("the paper's pump reaches 2.4"))?;
        within("[uncertainty] repeatability_percent", self.repeatability_percent, 0.0..=100.0)
            .map_err(|wrong| wrong.hint("the paper's pump reaches 0.47"))?;
        within("[uncertainty] roller_volume_ml", self.roller_volume_ml, 0.0..=1e4)
            .map_err(|wrong| wrong.hint("the paper's two figures differ by 0.045"))
    }
}
