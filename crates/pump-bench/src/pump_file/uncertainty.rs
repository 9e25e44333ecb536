//! `[uncertainty]`: how far to trust the model of the pump.

use serde::{Deserialize, Serialize};

use super::range::{WrongValue, within, within_if_given};

/// The table `[uncertainty]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct UncertaintyTable {
    /// Standard uncertainty of the model's volume, in percent of the volume.
    pub model_percent: f64,
    /// Standard uncertainty of the volume at a speed, where it depends on the speed more than the model says, in
    /// percent of the volume. `None` where `model_percent` contains it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_percent: Option<f64>,
    /// Standard deviation of repeated doses, in percent of the volume.
    pub repeatability_percent: f64,
    /// Volume of the doses that the repeatability was measured with, in mL. `None` stands for ten revolutions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeatability_at_ml: Option<f64>,
    /// Standard uncertainty of the volume of one roller, in mL. It dominates a dose within a single pulse.
    pub roller_volume_ml: f64,
}

impl UncertaintyTable {
    /// Refuses the first uncertainty outside its range.
    pub(super) fn check(&self) -> Result<(), WrongValue> {
        within("[uncertainty] model_percent", self.model_percent, 0.0..=100.0).map_err(|wrong| {
            wrong.hint("the paper's pump reaches 2.4, a pump that nobody weighed 6 to 19")
        })?;
        within_if_given("[uncertainty] speed_percent", self.speed_percent, 0.0..=100.0)
            .map_err(|wrong| wrong.hint("a pump that nobody weighed has 5.2"))?;
        within("[uncertainty] repeatability_percent", self.repeatability_percent, 0.0..=100.0)
            .map_err(|wrong| wrong.hint("the paper's pump reaches 0.47"))?;
        within_if_given("[uncertainty] repeatability_at_ml", self.repeatability_at_ml, 1e-3..=1e6)
            .map_err(|wrong| wrong.hint("the volume of the doses whose scatter was measured"))?;
        within("[uncertainty] roller_volume_ml", self.roller_volume_ml, 0.0..=1e4)
            .map_err(|wrong| wrong.hint("the paper's two figures differ by 0.045"))
    }

    /// Returns the standard uncertainty of a volume that nobody weighed, as a part of it.
    pub(super) fn unweighed(&self) -> f64 {
        let (model, speed) = (self.model_percent, self.speed_percent.unwrap_or(0.0));
        libm::sqrt(model * model + speed * speed) / 100.0
    }

    /// Returns the standard uncertainty of the volume over the motor's speeds, as a part of it: what the model leaves
    /// open of the dependence on the speed.
    pub(crate) fn over_speeds(&self) -> f64 {
        self.speed_percent.unwrap_or(self.model_percent) / 100.0
    }
}
