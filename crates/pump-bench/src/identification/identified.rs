//! A line that was identified. `report/identified.rs` has its words, its JSON and its table for a pump file.

use pump_model::identification::Estimate;
use pump_model::{Line, Port, metrics};

use super::WEAK_PEARSON;
use super::nozzle::Nozzle;
use crate::export::Fitted;
use crate::notice::Notice;
use crate::pump_file::PumpFile;

/// Part of the measured values within which a fit agrees with them but for rounding.
const ROUNDING: f64 = 1e-12;

/// A parameter of a line that was found or held.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
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
#[non_exhaustive]
pub struct Identified {
    /// Kind of identification: `resistance`, `compliance` or `line`.
    pub kind: &'static str,
    /// Port of the line.
    pub port: Port,
    /// First line of the report for people.
    pub headline: String,
    /// Parameters that were found and parameters that were held.
    pub parameters: Vec<Parameter>,
    /// Number of rows in the table. The fit uses fewer of a long recording.
    pub rows: usize,
    /// Measured points that the fit uses, and their fit, in kPa.
    pub points: Vec<Fitted>,
    /// Number of independent points that the points are worth.
    pub independent: f64,
    /// Covariances of the parameters that were sought, in their order and units, row by row. The roots of the diagonal
    /// are the standard uncertainties.
    pub covariance: Vec<f64>,
    /// Warnings for the user.
    pub warnings: Vec<Notice>,
    /// Line with the parameters that were found.
    pub line: Line,
    /// Nozzle at the line's end, for the pump file.
    pub nozzle: Option<Nozzle>,
}

impl Identified {
    /// Returns the result with the nozzle of `file`, if the line is the outlet's. The table for the pump file keeps it.
    #[must_use]
    pub fn with_nozzle_of(mut self, file: &PumpFile) -> Self {
        self.nozzle = (self.port == Port::Outlet).then(|| Nozzle::of(file));
        self
    }

    /// Adds a warning if the fit and the measured values do not rise and fall together.
    ///
    /// `is_expected` is false for a fit without an offset: points at one flow determine a line through the
    /// origin too.
    pub(super) fn with_weak_correlation(mut self, is_expected: bool) -> Self {
        let pearson = metrics::pearson(self.pairs());
        if is_expected && pearson.is_none_or(|pearson| pearson < WEAK_PEARSON) {
            let pearson = pearson.map_or("none".to_owned(), |pearson| format!("{pearson:.2}"));
            self.warnings.push(
                format!(
                    "the model explains less than half of what was measured: Pearson {pearson}, below \
                 {WEAK_PEARSON}; check the data and the other warnings before you use these values"
                )
                .into(),
            );
        }
        self
    }

    /// Returns true if the points tell how sure the parameters are. Points that lie on their fit but for
    /// rounding tell nothing, as two points that agree do.
    pub(crate) fn has_errors(&self) -> bool {
        let largest = self.points.iter().map(|point| point.measured.abs()).fold(0.0, f64::max);
        metrics::rmse(self.pairs()).is_some_and(|rmse| rmse > ROUNDING * largest)
    }

    /// Returns the pairs of fitted and measured values, in kPa.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        self.points.iter().map(|point| (point.fitted, point.measured))
    }
}
