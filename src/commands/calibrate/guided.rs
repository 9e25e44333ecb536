//! Guided runs: a run to try, then several at each of several speeds, each of them weighed.

use pump_bench::calibration::{
    CalibrationError, CalibrationRun, PlannedRuns, RunLog, UnfinishedRuns, Weighing, default_rate_left_out,
    now_utc,
};
use pump_bench::record::Purpose;
use pump_bench::report::ErrorKind;
use pump_bench::{Bench, DoseRequest, Prepared, Session};
use pump_ctl::plan::Cruise;
use pump_model::units::{degrees, rad_s};

use super::answers::{Answer, example};
use super::course::{GuidedCourse, short};
use super::scale::Scale;
use crate::advice;
use crate::commands::delivery::deliver;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{noted, say, warn, warn_of_pump};
use crate::warned::Warned;

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
    warn_of_pump(bench);
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
    say(&course.added(bench, range_rad_s));
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
    let each = format!("{}, {volume_ml:.1} mL by the model", counted(u64::from(pitches), "pitch", "pitches"));
    let vessel = "fill the line, and empty or tare the vessel before each";
    let time_of = |speed_rpm: &f64| run_s.iter().find(|(rpm, _)| rpm == speed_rpm).map_or(0.0, |(_, s)| *s);
    let trial_s = if made == 0 { planned.speeds_rpm.get(all / 2).map_or(0.0, time_of) } else { 0.0 };
    let motion_s = trial_s + planned.speeds_rpm.iter().skip(made).map(time_of).sum::<f64>();
    let pump = &bench.file().pump.id;
    let is_left = |rpm: &f64| planned.speeds_rpm.iter().skip(made).any(|left| left == rpm);
    let speeds: Vec<_> = run_s.iter().filter(|(rpm, _)| is_left(rpm)).map(|(rpm, _)| short(*rpm)).collect();
    let at = format!("at {} r/min", listed(&speeds));
    let motor = match bench.board_port() {
        Some(port) => format!("the motor of {pump} at {}", port.display()),
        None => format!("the simulated motor of {pump}"),
    };
    let time = format!("{motor} turns {at}, for {} in all, plus weighing time", lasting(motion_s));
    if made == 0 {
        format!("{} of {each}, after one to try; {vessel}\n{time}\n", counted(all as u64, "run", "runs"))
    } else {
        format!("{made} of {all} runs of {each}, are on record; {vessel} of the others\n{time}\n")
    }
}

/// A number with what it counts.
fn counted(number: u64, one: &str, several: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { several })
}

/// Words in a row: `14, 28 and 100`.
fn listed(words: &[String]) -> String {
    match words {
        [words @ .., last] if !words.is_empty() => format!("{} and {last}", words.join(", ")),
        words => words.concat(),
    }
}

/// A time for a person: seconds up to two minutes, then minutes.
fn lasting(time_s: f64) -> String {
    if time_s < 120.0 { format!("{time_s:.0} s") } else { format!("{:.0} min", time_s / 60.0) }
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
            self.scale.before()?;
            let prepared = self.prepare(speed_rpm)?;
            say(&format!("{title}: moving\n"));
            let (delivered, signal) = deliver(
                self.bench,
                &mut self.session,
                &prepared,
                &self.interrupt,
                self.json,
                &mut Warned::default(),
            )?;
            if !delivered.completed {
                return Err(Failure::stopped(signal.unwrap_or(0), true, "stopped by the user in a run"));
            }
            let plan = &prepared.plan;
            let known = plan.start().is_known(self.bench.model().pitch_rad());
            let example = example(&Weighing::of(self.bench.file()), plan.planned_ml());
            loop {
                let answer = self.scale.reading(title, &example, &mut self.session, &self.interrupt)?;
                let (reading, digit) = match answer {
                    Answer::Read(reading, digit) => (reading, digit),
                    Answer::Redo => break,
                    Answer::Quit => return Ok(None),
                };
                let run = CalibrationRun {
                    digit: Some(digit),
                    speed_rpm,
                    start_angle_deg: known.then_some(degrees(plan.start().angle_rad())),
                    start_half_width_deg: None,
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
    let reading = run.reading;
    let error = advice::told(&error);
    let message = format!("{error}; the reading {reading} of this run is not on record: note it down");
    Failure::fault(ErrorKind::Record, message)
}
