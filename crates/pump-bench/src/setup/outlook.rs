//! The outlook of a pump that was set up: how sure a dose is now, and what one more step would bring.

use libm::sqrt;
use pump_model::{ModelError, Pump};

use crate::bench::Bench;
use crate::calibration::{CalibrationError, Displacement, ScatterPrior};
use crate::dosing::{DoseError, DoseRequest, Share, ShareSource, one_more};
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

/// Returns the step of one more weighed dose, if few were weighed and another is worth its time.
///
/// # Errors
///
/// [`ModelError`] where a law cannot be computed for this pump.
fn weighing_step(
    base: &Pump,
    found: &Displacement,
    shares: &[Share],
    expanded_ml: f64,
) -> Result<Option<SurerStep>, ModelError> {
    let Some((prior, then)) = found.prior.filter(ScatterPrior::rests_on_few).zip(found.after_one_more())
    else {
        return Ok(None);
    };
    let rpm = found.reference_rpm;
    let of_mean = then.standard_at(base, rpm)? / found.standard_at(base, rpm)?;
    let of_scatter = then.prior.map_or(1.0, |then| then.widened() / prior.widened());
    let (mut now, mut after) = (0.0, 0.0);
    for share in shares {
        let variance = share.standard_ml * share.standard_ml;
        let part = match share.source {
            _ if share.prior.is_none() => 1.0,
            ShareSource::Repeatability => of_scatter,
            _ => of_mean,
        };
        now += variance;
        after += part * part * variance;
    }
    let at_best_ml = expanded_ml * sqrt(after / now);
    let is_worth = at_best_ml * at_best_ml < (1.0 - WORTH_PERCENT / 100.0) * expanded_ml * expanded_ml;
    Ok(is_worth.then(|| SurerStep { source: "weighing", notice: one_more(), at_best_ml }))
}

/// Step that makes doses surer.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SurerStep {
    /// Source of the uncertainty that the step reduces, as reports name it; `weighing` for one more weighed dose, which
    /// reduces calibration and repeatability.
    pub source: &'static str,
    /// Step in words, with its remedies.
    pub notice: Notice,
    /// Half width of the interval once the source is gone, in mL: the step brings this at best. One more weighed dose
    /// brings it if it scatters as the pump file says.
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
        let found = bench.calibrations().active()?.and_then(|stored| stored.calibration.displacement);
        let weighing = match &found {
            Some(found) => {
                weighing_step(bench.model(), found, &shares, expanded_ml).map_err(CalibrationError::from)?
            }
            None => None,
        };
        // A dose more to weigh is the way to these, too.
        shares.retain(|share| weighing.is_none() || share.prior.is_none());
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
            steps: weighing.into_iter().chain(steps).collect(),
        })
    }
}
