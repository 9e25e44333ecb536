//! Guided runs: a run to try, then several at each of several speeds, each of them weighed.

use std::iter;

use libm::{ceil, round};
use pump_bench::calibration::{
    CalibrationError, CalibrationRun, PlannedRuns, Reading, RunLog, UnfinishedRuns, Weighing,
    default_rate_left_out, now_utc,
};
use pump_bench::record::Purpose;
use pump_bench::report::ErrorKind;
use pump_bench::{Bench, DoseRequest, Prepared, Session};
use pump_ctl::plan::Cruise;
use pump_model::units::{degrees, rad_s, rpm};

use super::answers::Answer;
use super::scale::Scale;
use crate::advice;
use crate::commands::delivery::deliver;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{noted, say, warn, warn_of_fluid};

/// Volume of a run, mL: on a scale that shows 0.01 g a reading is then good to 2e-4.
const LEAST_ML: f64 = 50.0;

/// Most pitches of a run.
pub(super) const MOST_PITCHES: u32 = 100_000;

/// Runs at each speed.
const RUNS: u32 = 3;

/// Largest part of a run by which whole steps may miss its whole pitches.
const WHOLE_STEPS: f64 = 1e-4;

/// Slowest of the default speeds, over that of the default rate: doses a little slower than usual are covered too.
const SLOWEST: f64 = 0.5;

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
    fn planned(&self, bench: &Bench, range_rad_s: (f64, f64)) -> PlannedRuns {
        let speeds_rad_s = if self.speeds_rad_s.is_empty() {
            default_speeds_rad_s(bench, range_rad_s)
        } else {
            self.speeds_rad_s.clone()
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

    /// Returns the runs on record that the course goes on with, or `None` if it begins. Readings on record are
    /// neither used nor given up without a word.
    fn on_record(
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
        let refused = |of: String, now: String| {
            Err(Failure::refused(format!(
                "{count} of {all} readings of a guided calibration are on record for {of}, and now it is {now}; \
                 go back to that, or give the readings up with --anew"
            )))
        };
        let revolution =
            |planned: &PlannedRuns| format!("{:.4} mL of model volume per revolution", planned.revolution_ml);
        let fluid = |planned: &PlannedRuns| format!("{} at {} °C", planned.fluid, planned.temperature_degc);
        if wanted.revolution_ml != planned.revolution_ml {
            return refused(revolution(planned), revolution(&wanted));
        }
        if (&wanted.fluid, wanted.temperature_degc) != (&planned.fluid, planned.temperature_degc) {
            return refused(fluid(planned), fluid(&wanted));
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

/// Runs that were weighed.
pub(super) struct Weighed {
    /// Runs on record, in the order of the plan.
    pub(super) runs: Vec<CalibrationRun>,
    /// True if the rotor turned for some of them in this call.
    pub(super) has_moved: bool,
    /// Step of the balance's last digit, in g. `None` if a person typed the readings.
    pub(super) digit_g: Option<f64>,
}

/// Runs under guidance.
struct Guide<'a, 'b> {
    bench: &'a Bench,
    session: Session<'b>,
    log: RunLog,
    scale: Scale,
    interrupt: Interrupt,
    pitches: u32,
    temperature_degc: Option<f64>,
    json: bool,
}

/// Makes the runs and asks for the readings. Each reading is on record once it is typed. Runs that are on
/// record are not made again. Returns `None` if the person left.
pub(super) fn runs(bench: &Bench, course: &GuidedCourse, scale: Scale) -> Result<Option<Weighed>, Failure> {
    warn_of_fluid(bench);
    let mut session = bench.session()?;
    let connected = session.connect();
    noted(&mut session, connected)?;
    warn(&session.notes());
    let log = RunLog::of(bench.folder());
    let range_rad_s = session.speed_range_rad_s();
    let on_record = course.on_record(bench, &log, range_rad_s)?;
    let begins = on_record.is_none();
    let UnfinishedRuns { planned, runs, .. } =
        on_record.unwrap_or_else(|| UnfinishedRuns::begun(course.planned(bench, range_rad_s)));
    let interrupt = Interrupt::watch()?;
    let &GuidedCourse { temperature_degc, json, .. } = course;
    let pitches = planned.pitches;
    let mut guide = Guide { bench, session, log, scale, interrupt, pitches, temperature_degc, json };
    // Every speed is planned before anything moves.
    let mut speeds_rpm = planned.speeds_rpm.clone();
    speeds_rpm.dedup();
    let mut run_s = Vec::new();
    for speed_rpm in &speeds_rpm {
        run_s.push((*speed_rpm, guide.prepare(*speed_rpm)?.plan.profile().duration_s()));
    }
    say(&introduction(bench, &planned, runs.len(), &run_s));
    warn(default_rate_left_out(bench.file(), bench.model(), &planned.speeds_rpm).as_slice());
    if course.dry_run {
        say("dry run: nothing moves, and nothing is recorded\n");
        return Ok(None);
    }
    if begins {
        guide.log.begin(&planned)?;
    }
    let weighed = guide.weigh_all(&planned, runs, begins);
    let (has_moved, digit_g) = (guide.session.has_moved(), guide.scale.digit_g());
    match weighed {
        Ok(runs) => Ok(runs.map(|runs| Weighed { runs, has_moved, digit_g })),
        Err(failure) if has_moved => Err(failure.after_motion().with(&format!("; {}", kept(bench)))),
        Err(failure) => Err(failure),
    }
}

/// Says how many readings of a guided calibration are on record, and how to go on with them. It stands behind other
/// errors, so that an error of its own takes the place of none.
pub(super) fn kept(bench: &Bench) -> String {
    let found = match RunLog::of(bench.folder()).read() {
        Ok(found) => found,
        Err(error) => return format!("nor can the readings on record be read: {}", advice::told(&error)),
    };
    match found.map_or(0, |found| found.runs.len()) {
        0 => "no reading is on record".to_owned(),
        1 => "1 reading is on record: `dose calibrate run --continue` goes on with it".to_owned(),
        count => format!("{count} readings are on record: `dose calibrate run --continue` goes on with them"),
    }
}

/// The words that come first: which runs are to be made, and how long the motor turns for them. `run_s` has the time
/// of a run at each speed.
fn introduction(bench: &Bench, planned: &PlannedRuns, made: usize, run_s: &[(f64, f64)]) -> String {
    let (all, pitches) = (planned.speeds_rpm.len(), planned.pitches);
    let volume_ml = f64::from(pitches) * bench.model().outlet_curve().pitch_ml();
    let each = format!("{pitches} pitches, {volume_ml:.1} mL by the model");
    let vessel = "fill the line, and empty or tare the vessel before each";
    let time_of = |speed_rpm: &f64| run_s.iter().find(|(rpm, _)| rpm == speed_rpm).map_or(0.0, |(_, s)| *s);
    let trial_s = if made == 0 { planned.speeds_rpm.get(all / 2).map_or(0.0, time_of) } else { 0.0 };
    let motion_s = trial_s + planned.speeds_rpm.iter().skip(made).map(time_of).sum::<f64>();
    let time = format!("the motor turns for {} in all, besides the weighing", lasting(motion_s));
    if made == 0 {
        format!("{all} runs of {each}, after one to try; {vessel}\n{time}\n")
    } else {
        format!("{made} of {all} runs of {each}, are on record; {vessel} of the others\n{time}\n")
    }
}

/// A time for a person: seconds up to two minutes, then minutes.
fn lasting(time_s: f64) -> String {
    if time_s < 120.0 { format!("{time_s:.0} s") } else { format!("{:.0} min", time_s / 60.0) }
}

/// Three speeds: half of the default rate's, that of the default rate, and the fastest of the range.
fn default_speeds_rad_s(bench: &Bench, (least_rad_s, fastest_rad_s): (f64, f64)) -> Vec<f64> {
    let usual_rad_s = pump_ctl::plan::speed_for_flow(bench.model(), bench.file().pump.default_rate_ml_s);
    let in_range = |rad_s: f64| rad_s.max(least_rad_s).min(fastest_rad_s);
    let mut speeds_rad_s = vec![in_range(SLOWEST * usual_rad_s), in_range(usual_rad_s), fastest_rad_s];
    speeds_rad_s.dedup();
    speeds_rad_s
}

/// The whole pitches whose volume is nearest to `volume_ml`, one at least.
fn nearest_pitches(bench: &Bench, volume_ml: f64) -> u32 {
    round(volume_ml / bench.model().outlet_curve().pitch_ml()).clamp(1.0, f64::from(MOST_PITCHES)) as u32
}

/// The fewest pitches of [`LEAST_ML`] or more that are whole motor steps, or nearly so. Such a run has the same
/// volume from any angle.
fn default_pitches(bench: &Bench) -> u32 {
    let pitch_steps = bench.model().pitch_rad() / bench.file().limits().motor.step_rad();
    let fewest = ceil(LEAST_ML / bench.model().outlet_curve().pitch_ml()) as u32;
    // A head of up to 12 rollers has one among these.
    let mut counts = fewest..fewest + 12;
    let is_whole = |count: &u32| {
        let steps = f64::from(*count) * pitch_steps;
        (steps - round(steps)).abs() <= WHOLE_STEPS * steps
    };
    counts.find(is_whole).unwrap_or(fewest)
}

/// A number with four decimals at most.
fn short(value: f64) -> String {
    format!("{value:.4}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

impl Guide<'_, '_> {
    /// Makes the trial run if the course begins, then the runs that are not on record yet. Returns `None` if
    /// the person left.
    fn weigh_all(
        &mut self,
        planned: &PlannedRuns,
        runs: Vec<CalibrationRun>,
        begins: bool,
    ) -> Result<Option<Vec<CalibrationRun>>, Failure> {
        if begins {
            let middle_rpm =
                planned.speeds_rpm.get(planned.speeds_rpm.len() / 2).copied().unwrap_or_default();
            if self.weighed(middle_rpm, 1, "trial run")?.is_none() {
                return Ok(None);
            }
        }
        match self.rest_of(planned, runs)? {
            Some(runs) => self.last_may_be_repeated(runs),
            None => Ok(None),
        }
    }

    /// Asks whether the runs are kept, and repeats the last one as often as it is wanted. Returns `None` if the
    /// person left.
    fn last_may_be_repeated(
        &mut self,
        mut runs: Vec<CalibrationRun>,
    ) -> Result<Option<Vec<CalibrationRun>>, Failure> {
        let all = runs.len();
        while let Some(last) = runs.last() {
            say("enter keeps the calibration; redo repeats the last run; quit keeps the readings alone: ");
            match self.scale.line(&mut self.session, &self.interrupt, "keep")?.trim() {
                "" | "yes" | "keep" => break,
                "quit" => return Ok(None),
                "redo" => {
                    let title = format!("run {all} of {all}, again");
                    match self.weighed(last.speed_rpm, all, &title)? {
                        Some(run) => {
                            self.log.replace_last(&run).map_err(|error| unrecorded(error, &run))?;
                            runs.pop();
                            runs.push(run);
                        }
                        None => return Ok(None),
                    }
                }
                other => say(&format!("`{other}` is none of these\n")),
            }
        }
        Ok(Some(runs))
    }

    /// Makes the runs that are not on record yet. Returns `None` if the person left.
    fn rest_of(
        &mut self,
        planned: &PlannedRuns,
        mut runs: Vec<CalibrationRun>,
    ) -> Result<Option<Vec<CalibrationRun>>, Failure> {
        let all = planned.speeds_rpm.len();
        for speed_rpm in planned.speeds_rpm.iter().skip(runs.len()) {
            let title = format!("run {} of {all}, {} r/min", runs.len() + 1, short(*speed_rpm));
            let Some(run) = self.weighed(*speed_rpm, runs.len() + 1, &title)? else { return Ok(None) };
            self.log.add(&run).map_err(|error| unrecorded(error, &run))?;
            runs.push(run);
        }
        Ok(Some(runs))
    }

    fn prepare(&mut self, speed_rpm: f64) -> Result<Prepared, Failure> {
        let volume_ml = f64::from(self.pitches) * self.bench.model().outlet_curve().pitch_ml();
        let prepared = self.session.prepare(
            DoseRequest::new(Purpose::Calibrate, volume_ml)
                .with_cruise(Cruise::Speed { rad_s: rad_s(speed_rpm) }),
        );
        Ok(noted(&mut self.session, prepared)?)
    }

    /// Makes a run until there is a reading of it that can be right. Returns `None` if the person left.
    fn weighed(
        &mut self,
        speed_rpm: f64,
        number: usize,
        title: &str,
    ) -> Result<Option<CalibrationRun>, Failure> {
        loop {
            say(&format!("{title}: moving\n"));
            self.scale.before()?;
            let prepared = self.prepare(speed_rpm)?;
            let (delivered, signal) =
                deliver(self.bench, &mut self.session, &prepared, &self.interrupt, self.json)?;
            if !delivered.completed {
                return Err(Failure::stopped(signal.unwrap_or(0), true, "stopped by the user in a run"));
            }
            let plan = &prepared.plan;
            let known = plan.start().is_known(self.bench.model().pitch_rad());
            loop {
                let answer = self.scale.reading(title, &mut self.session, &self.interrupt)?;
                let reading = match answer {
                    Answer::Read(reading) => reading,
                    Answer::Redo => break,
                    Answer::Quit => return Ok(None),
                };
                let run = CalibrationRun {
                    speed_rpm,
                    start_angle_deg: known.then_some(degrees(plan.start().angle_rad())),
                    turned_deg: degrees(plan.steps() as f64 * plan.step_rad()),
                    reading,
                    temperature_degc: self.temperature_degc,
                    time: Some(now_utc()),
                };
                // The reading is refused, not the run.
                match run.volumes_ml(self.bench.model(), &Weighing::of(self.bench.file()), number) {
                    Ok(_) => return Ok(Some(run)),
                    Err(error) if self.scale.can_repeat() => say(&format!("{error}\n")),
                    Err(error) => return Err(Failure::of(error)),
                }
            }
        }
    }
}

/// Returns the failure to put a reading on record. It names the reading, so that it is not lost.
fn unrecorded(error: CalibrationError, run: &CalibrationRun) -> Failure {
    let reading = match run.reading {
        Reading::MassG(mass_g) => format!("{mass_g}g"),
        Reading::VolumeMl(volume_ml) => format!("{volume_ml}mL"),
    };
    let error = advice::told(&error);
    let message = format!("{error}; the reading {reading} of this run is not on record: note it down");
    Failure::fault(ErrorKind::Record, message)
}
