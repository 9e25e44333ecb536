//! The next dose to weigh: how sure doses are after a weighing, on which prior that rests, and what one more brings.

use libm::{hypot, sqrt};
use pump_model::Pump;
use pump_model::identification::widening;
use serde::Serialize;

use crate::calibration::{Calibration, CalibrationError, Displacement, ScatterPrior, Source, Stored};
use crate::notice::{Remedy, Wording};
use crate::numbers::{significant, two_digits};

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
    /// Volume of a dose like the last one from an unknown angle, whole pitches by this calibration, mL. `None` from a
    /// known angle, where a dose of the same volume does as well.
    whole_pitches_ml: Option<f64>,
    /// Number of doses to weigh next; 0 if few more bring little.
    more: usize,
    /// Certainty of the mean that they are expected to bring.
    then_mean_percent: f64,
    /// Certainty of a single dose that they are expected to bring.
    then_dose_percent: Option<f64>,
}

/// Standard uncertainties as parts of the volume.
#[derive(Debug, Clone, Copy)]
struct Sure {
    /// Standard uncertainty of the mean of many doses.
    mean: f64,
    /// Standard uncertainty of a dose, if it rests on a prior.
    dose: Option<f64>,
}

impl Sure {
    /// Returns the uncertainty of a dose, or of the mean where the scatter is known otherwise.
    fn of_most_use(&self) -> f64 {
        self.dose.unwrap_or(self.mean)
    }
}

impl NextWeighing {
    /// Returns the certainty by weighed doses. `None` of a calibration by other runs. The next dose is planned by the
    /// calibration `in_use`, which need not be this one.
    ///
    /// # Errors
    ///
    /// A displacement that cannot be had of this pump.
    pub(super) fn of(
        base: &Pump,
        stored: &Stored,
        in_use: Option<&Calibration>,
    ) -> Result<Option<Self>, CalibrationError> {
        let calibration = &stored.calibration;
        let (Some(found), Some(run)) = (&calibration.displacement, calibration.runs.last()) else {
            return Ok(None);
        };
        if calibration.source != Source::Last {
            return Ok(None);
        }
        let sure_of = |found: &Displacement| -> Result<Sure, CalibrationError> {
            let mean = found.whole_part_at(base, run.speed_rpm)?;
            Ok(Sure { mean, dose: found.prior.map(|prior| hypot(mean, prior.of_dose())) })
        };
        let now = sure_of(found)?;
        let mut after = Vec::new();
        if found.prior.is_some() {
            let mut then = found.clone();
            while let Some(more) = then.after_one_more().filter(|_| after.len() < MOST_MORE) {
                after.push(sure_of(&more)?);
                then = more;
            }
        } else {
            let means = standards_of_more(found, now.mean, calibration.runs.len());
            after.extend(means.into_iter().map(|mean| Sure { mean, dose: None }));
        }
        let next = (1..).zip(after).find(|(_, then)| then.of_most_use() < SURER * now.of_most_use());
        let (more, then) = next.unwrap_or((0, now));
        let percent = |standard: f64| 200.0 * standard;
        let is_anywhere = run.start_angle_deg.is_none();
        let whole_pitches_ml = match is_anywhere {
            true => {
                let planned = in_use.and_then(|in_use| in_use.displacement.as_ref());
                let factor = planned.map_or(Ok(1.0), |planned| planned.factor_at(base, run.speed_rpm))?;
                Some(factor * run.model_ml(base, calibration.runs.len())?)
            }
            false => None,
        };
        Ok(Some(Self {
            mean_percent: percent(now.mean),
            dose_percent: now.dose.map(percent),
            whole_pitches_ml,
            more,
            then_mean_percent: percent(then.mean),
            then_dose_percent: then.dose.map(percent),
        }))
    }

    /// Says how sure doses are, on which prior that rests, and first of all what one more weighing brings.
    pub(super) fn text(&self, found: &Displacement, words: Wording) -> String {
        let stated = found.prior.as_ref().map_or(String::new(), stated);
        format!("{stated}{}", self.offer(words))
    }

    fn offer(&self, words: Wording) -> String {
        let [now, then] = [self.mean_percent, self.then_mean_percent].map(two_digits);
        let of_dose = self.dose_percent.zip(self.then_dose_percent);
        let [now, then] = match of_dose.map(|(dose, then_dose)| (two_digits(dose), two_digits(then_dose))) {
            Some((dose, then_dose)) => [
                format!(
                    "one dose like this \u{b1} {dose} %, the mean of many such doses \u{b1} {now} % (k = 2); \
                     the last drop and the angle add to that"
                ),
                format!("about \u{b1} {then_dose} % for one, \u{b1} {then} % for the mean"),
            ],
            None => [
                format!(
                    "the mean of many doses at this speed \u{b1} {now} % (k = 2); one dose scatters more"
                ),
                format!("about \u{b1} {then} % for the mean"),
            ],
        };
        let doses = match self.more {
            0 => return format!("  now         {now}\n"),
            1 => "one more dose like this".to_owned(),
            more => format!("{more} more doses like this"),
        };
        let way = words(Remedy::WeighOneMore);
        let whole = |ml| format!(", of {} mL, which are whole pitches,", significant(ml, 5));
        let of_volume = self.whole_pitches_ml.map_or(String::new(), whole);
        format!(
            "  now         {now}\n  next        weigh {doses}{of_volume} before you rely on it: then {then}; \
             {way}\n"
        )
    }
}

/// Says which prior stands for the scatter that few doses do not show.
fn stated(prior: &ScatterPrior) -> String {
    let shows = match prior.weighed {
        1 => "one weighed dose shows no scatter".to_owned(),
        few if prior.rests_on_few() => format!("{few} weighed doses hardly show their scatter"),
        many => format!("{many} weighed doses show their scatter in part"),
    };
    let percent = significant(100.0 * prior.standard, 2);
    let known = 100.0 / sqrt(2.0 * f64::from(prior.degrees_of_freedom));
    let role = if prior.shown == 0 { "is assumed for a dose like this" } else { "is assumed beside theirs" };
    format!(
        "  assumed     {shows}: a scatter of {percent} % {role}, {} times that of the pump file; the true one may be \
         {known:.0} % smaller or larger\n",
        prior.over_expected
    )
}

/// Returns the standard uncertainties of the mean, as parts of the volume, that one more weighed dose and more are
/// expected to bring, where no prior stands beside them. So few doses show their scatter badly, and Student's t widens
/// it (GUM, table G.2): a second one alone brings nothing.
fn standards_of_more(found: &Displacement, standard: f64, weighed: usize) -> Vec<f64> {
    let reading = found.reading;
    let of_mean = sqrt((standard * standard - reading * reading).max(0.0));
    let of_one = found.scatter.standard().unwrap_or(of_mean * sqrt(weighed as f64));
    (1..=MOST_MORE)
        .map(|more| {
            let doses = weighed + more;
            let scattered = widening((doses - 1) as u32) * of_one / sqrt(doses as f64);
            sqrt(scattered * scattered + reading * reading)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn doses_from_four_on_show_their_scatter_in_part_and_the_prior_stands_beside_it() {
        let told = |weighed: u32| {
            let prior = json!({
                "degrees_of_freedom": 3, "over_expected": 1.3, "standard": 0.0061, "pooled": 0.006, "known": 0.0,
                "weighed": weighed, "shown": weighed - 1,
            });
            stated(&serde_json::from_value(prior).unwrap())
        };
        for (weighed, shows) in [
            (1, "one weighed dose shows no scatter: a scatter of 0.61 % is assumed for a dose like this"),
            (3, "3 weighed doses hardly show their scatter: a scatter of 0.61 % is assumed beside theirs"),
            (4, "4 weighed doses show their scatter in part: a scatter of 0.61 % is assumed beside theirs"),
        ] {
            assert!(told(weighed).contains(shows), "{}", told(weighed));
        }
    }
}
