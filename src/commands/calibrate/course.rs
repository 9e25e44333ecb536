//! The course of guided runs: their speeds and pitches, and the runs on record that it goes on with.

use std::iter;

use libm::{ceil, round};
use pump_bench::Bench;
use pump_bench::calibration::{PlannedRuns, RunLog, UnfinishedRuns};
use pump_model::units::rpm;

use crate::failure::Failure;
use crate::told_commands::shell_word;

/// Volume of a run that is enough for any head, mL: on a scale that shows 0.01 g a reading is then good to 2e-4.
const ENOUGH_ML: f64 = 50.0;

/// Least volume of a run, mL: on a scale that shows 0.01 g a reading is then good to 1e-3.
const LEAST_ML: f64 = 10.0;

/// Longest time of a run at the default rate, s, where that is no less than [`LEAST_ML`].
const RUN_S: f64 = 60.0;

/// Most pitches of a run.
pub(super) const MOST_PITCHES: u32 = 100_000;

/// Runs at each speed.
const RUNS: u32 = 3;

/// Largest part of a run by which whole steps may miss its whole pitches.
const WHOLE_STEPS: f64 = 1e-4;

/// Slowest of the default speeds, over that of the default rate: doses a little slower than usual are covered too.
const SLOWEST: f64 = 0.5;

/// Quotient of a speed that is given and that of the default rate within which the speed stands for it.
const NEAR: f64 = 1.05;

/// Speed that is added for the default rate, over or under that of the rate by the model: a tube displaces up to 15 %
/// more or less.
const BEYOND: f64 = 1.2;

/// The course of the runs, as far as it is given.
pub(super) struct GuidedCourse {
    /// Speeds of the runs, rad/s; empty for the usual ones.
    pub(super) speeds_rad_s: Vec<f64>,
    /// Runs at each speed.
    pub(super) each: Option<u32>,
    /// Whole pitches of each run.
    pub(super) pitches: Option<u32>,
    /// Volume of each run, mL, in place of its pitches: the nearest whole pitches.
    pub(super) volume_ml: Option<f64>,
    /// True if the runs are planned and told, and none is made.
    pub(super) dry_run: bool,
    /// True if the course goes on with the readings on record.
    pub(super) goes_on: bool,
    /// True if readings on record are given up.
    pub(super) anew: bool,
    /// Temperature of the fluid, °C.
    pub(super) temperature_degc: Option<f64>,
    /// True if a program reads the result.
    pub(super) json: bool,
}

impl GuidedCourse {
    /// True if the course says nothing of the runs, so that it fits whatever is on record.
    fn is_open(&self) -> bool {
        self.speeds_rad_s.is_empty()
            && self.each.is_none()
            && self.pitches.is_none()
            && self.volume_ml.is_none()
    }

    /// The runs in their order. `range_rad_s` are the slowest and the fastest speed that the device allows.
    pub(super) fn planned(&self, bench: &Bench, range_rad_s: (f64, f64)) -> PlannedRuns {
        let speeds_rad_s = match &self.speeds_rad_s[..] {
            [] => default_speeds_rad_s(bench, range_rad_s),
            given => with_default_rate(bench, range_rad_s, given),
        };
        let each = self.each.unwrap_or(RUNS) as usize;
        let model = bench.model();
        PlannedRuns {
            speeds_rpm: speeds_rad_s.into_iter().flat_map(|rad_s| iter::repeat_n(rpm(rad_s), each)).collect(),
            pitches: self.pitches.unwrap_or_else(|| match self.volume_ml {
                Some(volume_ml) => nearest_pitches(bench, volume_ml),
                None => default_pitches(bench),
            }),
            revolution_ml: model.revolution_ml(),
            fluid: bench.file().fluid.name.clone(),
            temperature_degc: bench.file().fluid.temperature_degc,
        }
    }

    /// Says which speed was added to those that are given.
    pub(super) fn added(&self, bench: &Bench, range_rad_s: (f64, f64)) -> String {
        let speeds_rad_s = with_default_rate(bench, range_rad_s, &self.speeds_rad_s);
        let added = speeds_rad_s.iter().find(|speed| !self.speeds_rad_s.contains(speed));
        let usual_rad_s = usual_rad_s(bench);
        let then = match (&self.speeds_rad_s[..], added) {
            ([], _) => return String::new(),
            (_, Some(added_rad_s)) => format!("runs at {} r/min are added", short(rpm(*added_rad_s))),
            ([one_rad_s], None) if !is_near(*one_rad_s, usual_rad_s) => {
                "the factor of the one speed is used there too, and less sure".to_owned()
            }
            _ => return String::new(),
        };
        format!(
            "--speeds leaves out the default rate of {} mL/s, {} r/min: {then}\n",
            short(bench.file().pump.default_rate_ml_s),
            short(rpm(usual_rad_s)),
        )
    }

    /// Returns the runs on record that the course goes on with, or `None` if it begins. Readings on record are
    /// neither used nor given up without a word.
    pub(super) fn on_record(
        &self,
        bench: &Bench,
        log: &RunLog,
        range_rad_s: (f64, f64),
    ) -> Result<Option<UnfinishedRuns>, Failure> {
        let found = if self.anew { None } else { log.unfinished(&bench.calibrations())? };
        match found {
            None if self.goes_on => Err(Failure::refused(
                "no guided calibration is unfinished: there is nothing to go on with; leave out --continue",
            )),
            None => Ok(None),
            Some(found) if self.goes_on => {
                self.check_goes_on(bench, &found, range_rad_s).map(|()| Some(found))
            }
            Some(found) => Err(Failure::refused(format!(
                "a guided calibration with {} of {} readings is on record; go on with it (`dose calibrate run \
                 --continue`), or give its readings up (`dose calibrate run --anew`)",
                found.runs.len(),
                found.planned.speeds_rpm.len()
            ))),
        }
    }

    /// Refuses to go on with runs that are not those of this course, or of another pump or fluid.
    fn check_goes_on(
        &self,
        bench: &Bench,
        on_record: &UnfinishedRuns,
        range_rad_s: (f64, f64),
    ) -> Result<(), Failure> {
        let UnfinishedRuns { planned, runs, .. } = on_record;
        let (count, all) = (runs.len(), planned.speeds_rpm.len());
        let wanted = self.planned(bench, range_rad_s);
        let refused = |of: String, now: String, back: &str| {
            Err(Failure::refused(format!(
                "{count} of {all} readings of a guided calibration are on record for {of}, and now it is {now}; \
                 {back}, or give the readings up with --anew"
            )))
        };
        let revolution =
            |planned: &PlannedRuns| format!("{:.4} mL of model volume per revolution", planned.revolution_ml);
        let fluid = |planned: &PlannedRuns| format!("{} at {} °C", planned.fluid, planned.temperature_degc);
        if wanted.revolution_ml != planned.revolution_ml {
            return refused(revolution(planned), revolution(&wanted), "go back to that");
        }
        if (&wanted.fluid, wanted.temperature_degc) != (&planned.fluid, planned.temperature_degc) {
            let fluid_option = match wanted.fluid == planned.fluid {
                true => String::new(),
                false => format!("--fluid {} ", shell_word(&planned.fluid)),
            };
            let back = format!("add {fluid_option}--temperature {}degC", planned.temperature_degc);
            return refused(fluid(planned), fluid(&wanted), &back);
        }
        if !self.is_open() && wanted != *planned {
            return Err(Failure::refused(format!(
                "the guided calibration with {count} of {all} readings on record has other runs than these; go on \
                 with it without --speeds, --runs, --pitches and --volume, or give its readings up with --anew"
            )));
        }
        Ok(())
    }
}

/// Three speeds: half of the default rate's, that of the default rate, and the fastest of the range.
fn default_speeds_rad_s(bench: &Bench, (least_rad_s, fastest_rad_s): (f64, f64)) -> Vec<f64> {
    let usual_rad_s = usual_rad_s(bench);
    let in_range = |rad_s: f64| rad_s.max(least_rad_s).min(fastest_rad_s);
    let mut speeds_rad_s = vec![in_range(SLOWEST * usual_rad_s), in_range(usual_rad_s), fastest_rad_s];
    speeds_rad_s.dedup();
    speeds_rad_s
}

/// The whole pitches whose volume is nearest to `volume_ml`, one at least.
fn nearest_pitches(bench: &Bench, volume_ml: f64) -> u32 {
    round(volume_ml / bench.model().outlet_curve().pitch_ml()).clamp(1.0, f64::from(MOST_PITCHES)) as u32
}

/// The fewest pitches of a run's volume or more that are whole motor steps, or nearly so. Such a run has the same
/// volume from any angle.
fn default_pitches(bench: &Bench) -> u32 {
    let pitch_steps = bench.model().pitch_rad() / bench.file().limits().motor.step_rad();
    let volume_ml = (RUN_S * bench.file().pump.default_rate_ml_s).clamp(LEAST_ML, ENOUGH_ML);
    let fewest = ceil(volume_ml / bench.model().outlet_curve().pitch_ml()) as u32;
    // A head of up to 12 rollers has one among these.
    let mut counts = fewest..fewest + 12;
    let is_whole = |count: &u32| {
        let steps = f64::from(*count) * pitch_steps;
        (steps - round(steps)).abs() <= WHOLE_STEPS * steps
    };
    counts.find(is_whole).unwrap_or(fewest)
}

/// Speed of the default rate, by the model.
fn usual_rad_s(bench: &Bench) -> f64 {
    pump_ctl::plan::speed_for_flow(bench.model(), bench.file().pump.default_rate_ml_s)
}

/// Returns true if runs at a speed stand for those of the default rate.
fn is_near(rad_s: f64, usual_rad_s: f64) -> bool {
    (1.0 / NEAR..=NEAR).contains(&(rad_s / usual_rad_s))
}

/// The speeds that are given, with one more where they leave out the default rate, are far from it, or leave it no
/// margin on one side. Doses that name no rate would be less sure, or refused once the runs show another factor. One
/// speed is used at every speed, so it is enough. A rate that the device cannot have is left out.
fn with_default_rate(bench: &Bench, (least_rad_s, most_rad_s): (f64, f64), given: &[f64]) -> Vec<f64> {
    let mut speeds_rad_s = given.to_vec();
    let fastest_rad_s = given.iter().copied().fold(0.0, f64::max);
    let slowest_rad_s = given.iter().copied().fold(f64::INFINITY, f64::min);
    let usual_rad_s = usual_rad_s(bench);
    if slowest_rad_s < fastest_rad_s && (least_rad_s..=most_rad_s).contains(&usual_rad_s) {
        let (below_rad_s, above_rad_s) =
            ((usual_rad_s / BEYOND).max(least_rad_s), (usual_rad_s * BEYOND).min(most_rad_s));
        if below_rad_s < slowest_rad_s {
            speeds_rad_s.insert(0, below_rad_s);
        } else if above_rad_s > fastest_rad_s {
            speeds_rad_s.push(above_rad_s);
        } else if !given.iter().any(|rad_s| is_near(*rad_s, usual_rad_s)) {
            speeds_rad_s.push(usual_rad_s);
            speeds_rad_s.sort_by(f64::total_cmp);
        }
    }
    speeds_rad_s
}

/// A number with four decimals at most.
pub(super) fn short(value: f64) -> String {
    format!("{value:.4}").trim_end_matches('0').trim_end_matches('.').to_owned()
}
