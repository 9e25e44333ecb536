//! The next dose to weigh: how sure doses are after a weighing, on which prior that rests, and what one more brings.

use libm::{hypot, sqrt};
use pump_model::Pump;
use pump_model::identification::widening;
use serde::Serialize;

use crate::calibration::{CalibrationError, Displacement, ScatterPrior, Source, Stored};
use crate::notice::{Remedy, Wording};
use crate::numbers::significant;

/// Part of the uncertainty that more doses must leave at most, so that they are worth their time.
const SURER: f64 = 0.9;

/// Most doses that a person is asked for.
const MOST_MORE: usize = 9;

/// Certainty of doses like the one that was weighed, now and after more of them: expanded, k = 2, in percent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct NextWeighing {
    /// Certainty of the mean of many doses.
    mean_percent: f64,
    /// Certainty of a single dose. `None` without a prior: its scatter is the pump file's or that of the runs.
    dose_percent: Option<f64>,
    /// Number of doses to weigh next; 0 if few more bring little.
    more: usize,
    /// Certainty of the mean that they are expected to bring.
    then_mean_percent: f64,
    /// Certainty of a single dose that they are expected to bring.
    then_dose_percent: Option<f64>,
}

impl NextWeighing {
    /// Returns the certainty by weighed doses. `None` of a calibration by other runs.
    ///
    /// # Errors
    ///
    /// A displacement that cannot be had of this pump.
    pub(super) fn of(base: &Pump, stored: &Stored) -> Result<Option<Self>, CalibrationError> {
        let calibration = &stored.calibration;
        let (Some(found), Some(run)) = (&calibration.displacement, calibration.runs.last()) else {
            return Ok(None);
        };
        if calibration.source != Source::Last {
            return Ok(None);
        }
        let standard = found.whole_standard_at(base, run.speed_rpm)?;
        let percent = |standard: f64| 200.0 * standard / found.factor;
        let of_dose =
            |found: &Displacement, standard: f64| found.prior.map(|prior| hypot(standard, prior.of_dose()));
        let now = [Some(standard), of_dose(found, standard)];
        let mut after = vec![(0, now)];
        let mut then = found.after_one_more();
        while let Some(more) = then.take().filter(|_| after.len() <= MOST_MORE) {
            let standard = more.whole_standard_at(base, run.speed_rpm)?;
            after.push((after.len(), [Some(standard), of_dose(&more, standard)]));
            then = more.after_one_more();
        }
        if found.prior.is_none() {
            let more = standards_of_more(found, standard, calibration.runs.len());
            after.extend(more.into_iter().map(|(more, standard)| (more, [Some(standard), None])));
        }
        // A dose is what people want to be sure of; its mean where the scatter is known otherwise.
        let sure = |[mean, dose]: [Option<f64>; 2]| dose.or(mean).unwrap_or(0.0);
        let is_surer = |then: [Option<f64>; 2]| sure(then) < SURER * sure(now);
        let next = after.iter().copied().find(|(more, then)| *more > 0 && is_surer(*then));
        let (more, [then_mean, then_dose]) = next.unwrap_or((0, now));
        Ok(Some(Self {
            mean_percent: percent(standard),
            dose_percent: now[1].map(percent),
            more,
            then_mean_percent: percent(then_mean.unwrap_or(standard)),
            then_dose_percent: then_dose.map(percent),
        }))
    }

    /// Says how sure doses are, on which prior that rests, and first of all what one more weighing brings.
    pub(super) fn text(&self, found: &Displacement, words: Wording) -> String {
        let stated = found.prior.map_or(String::new(), |prior| stated(&prior, found.factor));
        format!("{stated}{}", self.offer(words))
    }

    fn offer(&self, words: Wording) -> String {
        let said = |mean: f64, dose: Option<f64>| match dose {
            Some(dose) => format!("a dose like this \u{b1} {dose:.2} %, the mean of many \u{b1} {mean:.2} %"),
            None => format!("\u{b1} {mean:.2} % before the scatter of a single dose"),
        };
        let now = said(self.mean_percent, self.dose_percent);
        if self.more == 0 {
            return format!("  sure now    {now} (k = 2)\n");
        }
        let doses =
            if self.more == 1 { "one more dose".to_owned() } else { format!("{} more doses", self.more) };
        let then = said(self.then_mean_percent, self.then_dose_percent);
        let way = words(Remedy::WeighOneMore);
        format!(
            "  sure now    {now} (k = 2)\n  next        weigh {doses}, which bring{} about {then}: {way}\n",
            if self.more == 1 { "s" } else { "" }
        )
    }
}

/// Says which prior stands for the scatter that few doses do not show.
fn stated(prior: &ScatterPrior, factor: f64) -> String {
    let shows = match prior.weighed {
        1 => "one weighed dose shows no scatter".to_owned(),
        few if prior.rests_on_few() => format!("{few} weighed doses hardly show their scatter"),
        many => format!("{many} weighed doses show their scatter"),
    };
    let percent = significant(100.0 * prior.standard / factor, 2);
    let known = 100.0 / sqrt(2.0 * f64::from(prior.degrees_of_freedom));
    let role = if prior.shown == 0 { "stands for it" } else { "counts beside it" };
    format!(
        "  prior       {shows}: a stated prior {role}, {percent} % of a dose like this, {} times the pump file's \
         scatter and known to {known:.0} % of itself\n",
        prior.over_expected
    )
}

/// Returns the standard uncertainties of the factor that more weighed doses are expected to bring, each with its number
/// of doses, where no prior stands beside them. So few doses show their scatter badly, and Student's t widens it (GUM,
/// table G.2): a second one alone brings nothing.
fn standards_of_more(found: &Displacement, standard: f64, weighed: usize) -> Vec<(usize, f64)> {
    let reading = found.reading;
    let of_mean = sqrt((standard * standard - reading * reading).max(0.0));
    let of_one = found.scatter.standard().unwrap_or(of_mean * sqrt(weighed as f64));
    (1..=MOST_MORE)
        .map(|more| {
            let doses = weighed + more;
            let scattered = widening((doses - 1) as u32) * of_one / sqrt(doses as f64);
            (more, sqrt(scattered * scattered + reading * reading))
        })
        .collect()
}
