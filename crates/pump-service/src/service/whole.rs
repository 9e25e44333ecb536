//! A dose that was stopped and resumed, as a whole: the log has its parts.

use pump_bench::Bench;
use pump_bench::record::{LogEntry, LogLine, Stamp};
use serde::Serialize;

/// Dose that was stopped and resumed, all its parts together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct WholeDose {
    /// Time at which its first part began, RFC 3339.
    pub time: Stamp,
    /// Volume that was asked for, mL.
    pub requested_ml: f64,
    /// Volume of the parts before the last one, mL.
    pub before_ml: f64,
    /// Volume of all parts, mL.
    pub delivered_ml: f64,
    /// Smallest volume of all parts, mL; null where the steps of each are known.
    pub delivered_least_ml: Option<f64>,
    /// Largest volume of all parts, mL; null where the steps of each are known.
    pub delivered_most_ml: Option<f64>,
    /// Expanded uncertainty (k = 2) of all parts, mL: their errors have one sign. Null where one part has none.
    pub expanded_uncertainty_ml: Option<f64>,
}

impl WholeDose {
    /// Reads the parts of the dose that ends with `last`. `None` if that is no rest, or the log cannot be read.
    pub(super) fn of(bench: &Bench, last: &LogEntry) -> Option<Self> {
        if !last.resumed {
            return None;
        }
        let mut whole: Option<Self> = None;
        for line in bench.log().ok()? {
            let LogLine::Dose(entry) = line.ok()? else { continue };
            // Neither a retraction nor the run of a calibration has a rest, so they lie between two doses.
            if entry.purpose != last.purpose || entry.number > last.number {
                continue;
            }
            whole = match whole {
                Some(before) if entry.resumed => Some(before.with(&entry)),
                _ => (!entry.resumed).then(|| Self::begun(&entry)),
            };
        }
        whole
    }

    fn begun(entry: &LogEntry) -> Self {
        let (least_ml, most_ml) = entry.delivered_range_ml.unzip();
        Self {
            time: entry.time,
            requested_ml: entry.requested_ml,
            before_ml: 0.0,
            delivered_ml: entry.delivered_ml,
            delivered_least_ml: least_ml,
            delivered_most_ml: most_ml,
            expanded_uncertainty_ml: entry.expanded_uncertainty_ml,
        }
    }

    fn with(self, rest: &LogEntry) -> Self {
        let range_ml = |of: Option<(f64, f64)>, sure_ml: f64| of.unwrap_or((sure_ml, sure_ml));
        let before_ml = range_ml(self.delivered_least_ml.zip(self.delivered_most_ml), self.delivered_ml);
        let rest_ml = range_ml(rest.delivered_range_ml, rest.delivered_ml);
        let is_unsure = self.delivered_least_ml.is_some() || rest.delivered_range_ml.is_some();
        let sure_ml = self.expanded_uncertainty_ml.zip(rest.expanded_uncertainty_ml);
        Self {
            before_ml: self.delivered_ml,
            delivered_ml: self.delivered_ml + rest.delivered_ml,
            delivered_least_ml: is_unsure.then_some(before_ml.0 + rest_ml.0),
            delivered_most_ml: is_unsure.then_some(before_ml.1 + rest_ml.1),
            expanded_uncertainty_ml: sure_ml.map(|(before_ml, rest_ml)| before_ml + rest_ml),
            ..self
        }
    }
}
