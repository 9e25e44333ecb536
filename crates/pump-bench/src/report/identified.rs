//! An identified line in words, as JSON and as lines for a pump file.

use libm::{floor, log};
use pump_model::identification::Estimate;
use pump_model::metrics;
use serde_json::{Map, json};

use crate::identification::{Identified, Nozzle};
use crate::notice::Wording;
use crate::numbers::significant;

/// Significant digits of a value whose points tell no error.
const DIGITS: i32 = 6;

impl Identified {
    /// The table of the pump file with what was found.
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
                Some(found) if !self.has_errors() => {
                    format!("{key} = {}  # found\n", significant(found.found.value, DIGITS))
                }
                // One digit more than is known.
                Some(found) => format!("{key} = {value:.*}  # found\n", decimals(found.found.standard) + 1),
                None => format!("{key} = {value:?}\n"),
            };
        }
        text + &self.nozzle.map_or(String::new(), |nozzle| nozzle_keys(&nozzle))
    }

    /// The identified line whose warnings have their remedies in a front end's words.
    #[must_use]
    pub fn worded(mut self, words: Wording) -> Self {
        for notice in &mut self.warnings {
            *notice = notice.told(words);
        }
        self
    }

    /// One line of JSON, `identification/1`.
    pub fn json(&self) -> String {
        let parameters: Map<_, _> = self
            .parameters
            .iter()
            .map(|parameter| {
                let Estimate { value, standard } = parameter.found;
                let is_told = parameter.is_held || self.has_errors();
                let standard = is_told.then_some(standard);
                let found = json!({ "value": value, "standard": standard, "held": parameter.is_held });
                (parameter.key.to_owned(), found)
            })
            .collect();
        let report = json!({
            "schema": "identification/1",
            "kind": self.kind,
            "line": self.port.name(),
            "parameters": parameters,
            "rows": self.rows,
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

    /// The words for people: parameters, the fit and the lines for the pump file.
    pub fn text(&self) -> String {
        let mut text = format!("{}; ± is k = 2\n", self.headline);
        for parameter in &self.parameters {
            let Estimate { value, standard } = parameter.found;
            let (name, unit) = (parameter.name, parameter.unit);
            text += &if parameter.is_held {
                format!("  {name:<13}{value} {unit}, held\n")
            } else if !self.has_errors() {
                let (value, count) = (significant(value, DIGITS), self.points.len());
                format!("  {name:<13}{value} {unit}, no error from {count} points that agree exactly\n")
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

/// The keys of the nozzle, which the table of the pump file keeps.
fn nozzle_keys(nozzle: &Nozzle) -> String {
    let end = nozzle.end.map(|end| format!("end = \"{end}\"\n"));
    let bore = nozzle.bore_mm.map(|bore_mm| format!("nozzle_bore_mm = {bore_mm:?}\n"));
    end.unwrap_or_default() + &bore.unwrap_or_default()
}

/// Decimals with which twice a standard uncertainty has two digits.
fn decimals(standard: f64) -> usize {
    let magnitude = floor(log(2.0 * standard) / std::f64::consts::LN_10);
    // An exact fit has an infinite logarithm. No measurement has more digits than these.
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
