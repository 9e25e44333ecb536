//! The outlook of a pump that was set up: how sure a dose is now, and what one more step would bring.

use libm::sqrt;

use crate::bench::Bench;
use crate::dosing::{DoseError, DoseRequest};
use crate::notice::Notice;
use crate::report::DoseReport;

/// Part of the variance below which a source is not worth a step.
const WORTH_PERCENT: f64 = 10.0;

/// Certainty of a dose, and the steps that make it surer.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Outlook {
    /// Volume of the dose, in mL.
    pub volume_ml: f64,
    /// Half width of the interval around the planned volume that holds 95 % of such doses, in mL.
    pub expanded_ml: f64,
    /// Lower bound of that interval, in mL.
    pub least_ml: f64,
    /// Upper bound of that interval, in mL.
    pub most_ml: f64,
    /// Steps that make doses surer, the best first.
    pub steps: Vec<SurerStep>,
}

/// Step that makes doses surer.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SurerStep {
    /// Source of the uncertainty that the step reduces, as reports name it.
    pub source: &'static str,
    /// Step in words, with its remedies.
    pub notice: Notice,
    /// Half width of the interval once the source is gone, in mL: the step brings this at best.
    pub at_best_ml: f64,
}

impl Outlook {
    /// Returns the outlook of a dose of `volume_ml` from where the rollers stand. Moves and records nothing.
    ///
    /// A share of the variance goes with its source, so the rest is U sqrt(1 - share): shares are independent (GUM,
    /// JCGM 100:2008, 5.1.2).
    ///
    /// # Errors
    /// [`DoseError`] if the dose cannot be planned.
    pub fn of(bench: &Bench, volume_ml: f64) -> Result<Self, DoseError> {
        let prepared = bench.prepare(DoseRequest::dose(volume_ml))?;
        let report = DoseReport::new(bench, &prepared, None);
        let expanded_ml = report.expanded_uncertainty_ml;
        let mut shares = report.uncertainty_budget;
        shares.retain(|share| share.variance_percent >= WORTH_PERCENT);
        shares.sort_by(|one, other| other.variance_percent.total_cmp(&one.variance_percent));
        let steps = shares.into_iter().map(|share| SurerStep {
            source: share.source.as_str(),
            at_best_ml: expanded_ml * sqrt((1.0 - share.variance_percent / 100.0).max(0.0)),
            notice: share.remedy,
        });
        Ok(Self {
            volume_ml,
            expanded_ml,
            least_ml: report.planned_ml - expanded_ml,
            most_ml: report.planned_ml + expanded_ml,
            steps: steps.collect(),
        })
    }
}
