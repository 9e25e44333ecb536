//! An identified line in words, as JSON and as a table for a pump file.

use pump_model::identification::Estimate;
use pump_model::math::{floor, log};
use pump_model::{Line, Port, metrics};
use serde_json::{Map, json};

use super::WEAK_PEARSON;
use crate::export::Fitted;

/// A parameter of a line that was found or held.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Key of the parameter with its unit, as in pump files and JSON.
    pub key: &'static str,
    /// Name of the parameter, for people.
    pub name: &'static str,
    /// Unit of the parameter.
    pub unit: &'static str,
    /// Value of the parameter and its standard uncertainty.
    pub found: Estimate,
    /// True if the parameter was held and not sought.
    pub is_held: bool,
}

impl Parameter {
    /// Makes a parameter that was sought and found.
    pub(super) fn found(key: &'static str, name: &'static str, unit: &'static str, found: Estimate) -> Self {
        Self { key, name, unit, found, is_held: false }
    }
}

/// A line that was identified, with its report.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// Kind of identification: `resistance`, `compliance` or `line`.
    pub kind: &'static str,
    /// Port of the line.
    pub port: Port,
    /// First line of the report for people.
    pub headline: String,
    /// Parameters that were found and parameters that were held.
    pub parameters: Vec<Parameter>,
    /// Measured points and their fit, in kPa.
    pub points: Vec<Fitted>,
    /// Number of independent points that the points are worth.
    pub independent: f64,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// Line with the parameters that were found.
    pub line: Line,
}

impl Identified {
    /// Adds a warning if the fit and the measured values do not rise and fall together.
    ///
    /// `is_expected` is false for a fit without an offset: points at one flow determine a line through the
    /// origin too.
    pub(super) fn with_weak_correlation(mut self, is_expected: bool) -> Self {
        let pearson = metrics::pearson(self.pairs());
        if is_expected && pearson.is_none_or(|pearson| pearson < WEAK_PEARSON) {
            let pearson = pearson.map_or("none".to_owned(), |pearson| format!("{pearson:.2}"));
            self.warnings.push(format!(
                "the model explains less than half of what was measured: Pearson {pearson}, below \
                 {WEAK_PEARSON}; check the data and the other warnings before you use these values"
            ));
        }
        self
    }

    /// Returns the pairs of fitted and measured values.
    fn pairs(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        self.points.iter().map(|point| (point.fitted, point.measured))
    }

    /// Returns the table of the pump file with the parameters that were found.
    fn pump_file(&self) -> String {
        let line = &self.line;
        let mut text = format!("[{}]\n", self.port.name());
        for (key, value) in [
            ("resistance_kpa_s_ml", line.resistance_kpa_s_ml),
            ("compliance_ml_kpa", line.compliance_ml_kpa),
            ("inertance_kpa_s2_ml", line.inertance_kpa_s2_ml),
            ("reservoir_kpa", line.reservoir_kpa),
        ] {
            let found = self.parameters.iter().find(|parameter| parameter.key == key && !parameter.is_held);
            text += &match found {
                // One digit more than the uncertainty leaves.
                Some(found) => format!("{key} = {value:.*}  # found\n", decimals(found.found.standard) + 1),
                None => format!("{key} = {value:?}\n"),
            };
        }
        text
    }

    /// Returns the report as one line of JSON, with the schema `identification/1`.
    pub fn json(&self) -> String {
        let parameters: Map<_, _> = self
            .parameters
            .iter()
            .map(|parameter| {
                let Estimate { value, standard } = parameter.found;
                let found = json!({ "value": value, "standard": standard, "held": parameter.is_held });
                (parameter.key.to_owned(), found)
            })
            .collect();
        let report = json!({
            "schema": "identification/1",
            "kind": self.kind,
            "line": self.port.name(),
            "parameters": parameters,
            "points": self.points.len(),
            "independent_points": self.independent,
            "rmse_kpa": metrics::rmse(self.pairs()),
            "nrmse": metrics::nrmse(self.pairs()),
            "pearson": metrics::pearson(self.pairs()),
            "warnings": self.warnings,
            "pump_file": self.pump_file(),
        });
        format!("{report}\n")
    }

    /// Returns the report for people.
    pub fn text(&self) -> String {
        let mut text = format!("{}; ± is k = 2\n", self.headline);
        for parameter in &self.parameters {
            let Estimate { value, standard } = parameter.found;
            let (name, unit) = (parameter.name, parameter.unit);
            text += &if parameter.is_held {
                format!("  {name:<13}{value} {unit}, held\n")
            } else {
                let digits = decimals(standard);
                format!("  {name:<13}{value:.digits$} ± {:.digits$} {unit}\n", 2.0 * standard)
            };
        }
        let metric = |value: Option<f64>, factor: f64, unit: &str| {
            value.map_or("none".to_owned(), |value| format!("{:.4}{unit}", factor * value))
        };
        text += &format!(
            "  {:<13}RMSE {}, NRMSE {} of the mean, Pearson {}\n",
            "fit",
            metric(metrics::rmse(self.pairs()), 1.0, " kPa"),
            metric(metrics::nrmse(self.pairs()), 100.0, " %"),
            metric(metrics::pearson(self.pairs()), 1.0, ""),
        );
        for warning in &self.warnings {
            text += &format!("  warning      {warning}\n");
        }
        text + &format!("for the pump file, in place of its [{}]:\n{}", self.port.name(), self.pump_file())
    }
}

/// Returns the number of decimals with which twice a standard uncertainty has two digits.
fn decimals(standard: f64) -> usize {
    let magnitude = floor(log(2.0 * standard) / std::f64::consts::LN_10);
    // An exact fit has an infinite logarithm. No measurement has more than 9 decimals.
    (1.0 - magnitude).clamp(0.0, 9.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uncertainties_have_two_digits() {
        for (standard, digits) in [(0.000_6, 4), (0.05, 2), (0.049, 3), (7.0, 0), (400.0, 0), (0.0, 9)] {
            assert_eq!(decimals(standard), digits, "{standard}");
        }
    }
}
