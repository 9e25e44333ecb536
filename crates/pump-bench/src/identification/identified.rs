//! A line that was identified. Its words, its JSON and its lines for a pump file stand in `report/identified.rs`.

use pump_model::identification::Estimate;
use pump_model::{Line, Port, metrics};

use super::WEAK_PEARSON;
use crate::export::Fitted;

/// A parameter that was found, or held.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name with its unit, as in pump files and JSON.
    pub key: &'static str,
    /// For people.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Value and standard uncertainty.
    pub found: Estimate,
    /// Whether it was held and not sought.
    pub is_held: bool,
}

impl Parameter {
    pub(super) fn found(key: &'static str, name: &'static str, unit: &'static str, found: Estimate) -> Self {
        Self { key, name, unit, found, is_held: false }
    }
}

/// A line that was identified, and all that is said of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// `resistance`, `compliance` or `line`.
    pub kind: &'static str,
    /// Whose line it is.
    pub port: Port,
    /// The first line for people.
    pub headline: String,
    /// What was found, and what was held.
    pub parameters: Vec<Parameter>,
    /// What was measured, kPa, and fitted.
    pub points: Vec<Fitted>,
    /// How many independent points they are worth.
    pub independent: f64,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// The line with what was found in it.
    pub line: Line,
}

impl Identified {
    /// Adds a warning where the fit and what was measured do not rise and fall together, which `is_expected` of a fit with an
    /// offset: points at one flow determine a line through the origin too.
    pub(super) fn with_weak_correlation(mut self, is_expected: bool) -> Self {
        let pearson = metrics::pearson(self.pairs());
        if is_expected && pearson.is_none_or(|pearson| pearson < WEAK_PEARSON) {
            let pearson = pearson.map_or("none".to_owned(), |pearson| format!("{pearson:.2}"));
            self.warnings.push(format!(
                "the model explains less than half of what was measured: Pearson {pearson}, and from {WEAK_PEARSON} on it is said to; \
                 check the data and what was said of them before you use these values"
            ));
        }
        self
    }

    /// Fitted and measured values, kPa.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        self.points.iter().map(|point| (point.fitted, point.measured))
    }
}
