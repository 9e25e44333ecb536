//! `[uncertainty]`: how far to trust the model of the pump.

mod unweighed;

use serde::{Deserialize, Serialize};

use super::range::{WrongValue, within, within_if_given};
pub(crate) use unweighed::Unweighed;

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
    /// Standard uncertainty of the volume of one roller, in mL. It dominates a dose within a single pulse. `None`
    /// beside `[head]`, whose default pulse has its own uncertainty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roller_volume_ml: Option<f64>,
    /// True if the pump file states no uncertainty, so that the one of a pump that nobody weighed stands in.
    #[serde(skip)]
    pub(crate) assumed: bool,
    /// True if the pump file states the uncertainty of McIntyre et al. for another head than theirs, so that the one
    /// of a pump that nobody weighed stands in.
    #[serde(skip)]
    pub(crate) replaces_papers: bool,
}

impl UncertaintyTable {
    /// Returns the uncertainty of a bought head that nobody weighed. Its tube has a bore of this diameter, in mm, if it
    /// is known.
    ///
    /// Repeated doses are taken to scatter as McIntyre et al. measured: 1 mL of 212.5 mL, the largest standard
    /// deviation of ten revolutions under 160 r/min. The 2.4 % of their model is of their pump, and no share of this.
    pub(crate) fn of_bought(bore_mm: Option<f64>) -> Self {
        let unweighed = Unweighed::of_bore(bore_mm);
        let tenths = |percent: f64| libm::floor(10.0 * percent + 0.5) / 10.0;
        Self {
            model_percent: tenths(unweighed.model_percent),
            speed_percent: Some(tenths(unweighed.speed_percent)),
            repeatability_percent: 0.47,
            repeatability_at_ml: None,
            roller_volume_ml: None,
            assumed: true,
            replaces_papers: false,
        }
    }

    /// Returns true if the pump file states no uncertainty.
    pub(crate) fn is_assumed(&self) -> bool {
        self.assumed
    }

    /// Refuses the first uncertainty outside its range.
    pub(super) fn check(&self) -> Result<(), WrongValue> {
        within("[uncertainty] model_percent", self.model_percent, 0.0..=100.0).map_err(|wrong| {
            wrong.hint("the paper's pump reaches 2.4, a pump that nobody weighed 6 to 19")
        })?;
        within_if_given("[uncertainty] speed_percent", self.speed_percent, 0.0..=100.0)
            .map_err(|wrong| wrong.hint("a pump that nobody weighed has 2.9 to 8.7"))?;
        within("[uncertainty] repeatability_percent", self.repeatability_percent, 0.0..=100.0)
            .map_err(|wrong| wrong.hint("the paper's pump reaches 0.47"))?;
        within_if_given("[uncertainty] repeatability_at_ml", self.repeatability_at_ml, 1e-3..=1e6)
            .map_err(|wrong| wrong.hint("the volume of the doses whose scatter was measured"))?;
        within_if_given("[uncertainty] roller_volume_ml", self.roller_volume_ml, 0.0..=1e4)
            .map_err(|wrong| wrong.hint("the paper's two figures differ by 0.045"))
    }

    /// Returns the standard uncertainty of a roller's volume, in mL. It is 0 where the default pulse of `[head]` has
    /// its own.
    pub(crate) fn roller_standard_ml(&self) -> f64 {
        self.roller_volume_ml.unwrap_or(0.0)
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

impl Default for UncertaintyTable {
    /// Returns the uncertainty of a bought head of which not even the bore is known.
    fn default() -> Self {
        Self::of_bought(None)
    }
}
