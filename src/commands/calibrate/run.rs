//! `dose calibrate run`: runs in, a calibration out that the next dose uses.

use std::path::PathBuf;

use clap::Args;
use pump_bench::Bench;
use pump_bench::calibration::{Calibration, CalibrationRun, Fit, RunLog, Source, Stored, runs_of_csv};
use pump_bench::report::{ErrorKind, calibration_json, calibration_text};
use pump_bench::units::{self, count};

use super::course::{GuidedCourse, MOST_PITCHES};
use super::guided::{self, Weighed, kept};
use super::reading::{NOTHING_KEPT, ReadingOptions, in_table, next_number, read};
use super::scale::Scale;
use crate::advice;
use crate::failure::Failure;
use crate::on_fail::OnFail;
use crate::options::balance::BalanceOptions;
use crate::options::bench::BenchOptions;
use crate::options::choice::choice;
use crate::options::fluid::FluidOptions;
use crate::options::report::FormatOption;
use crate::options::unattended::OnFailOption;
use crate::terminal::{print_json, tell};

#[derive(Debug, Args)]
pub(super) struct RunArgs {
    /// Table of runs, CSV: speed_rpm, turned_deg (or revolutions, steps), mass_g (or volume_ml), start_angle_deg, ...
    #[arg(long, value_name = "FILE", conflicts_with_all = ["port", "configure"])]
    from: Option<PathBuf>,
    /// Fit a line or parabola over the speed, a line alone, one factor, or the speed law (three speeds at least)
    #[arg(long, value_name = "best|line|factor|speed-law", default_value_t = Fit::Best, hide_default_value = true)]
    #[arg(value_parser = choice(&[
        (Fit::Best, "A straight line over the speed, or a parabola where an F test at four speeds or more asks for it"),
        (Fit::Line, "A straight line over the speed"),
        (Fit::Factor, "One factor for every speed"),
        (Fit::Law, "s and D of the speed law"),
    ]))]
    fit: Fit,
    /// Speeds of the guided runs, as 20rpm,60rpm,100rpm [default: three, from half the default rate to the limit]
    #[arg(long, value_name = "SPEEDS", value_delimiter = ',', value_parser = units::speed_rad_s)]
    #[arg(conflicts_with = "from")]
    speeds: Vec<f64>,
    /// Guided runs at each speed [default: 3]
    #[arg(long, value_name = "N", value_parser = count("number of runs", 1..=100), conflicts_with = "from")]
    runs: Option<u32>,
    /// Whole pitches of each guided run [default: 50 mL or more]
    #[arg(long, value_name = "N", value_parser = count("number of pitches", 1..=MOST_PITCHES))]
    #[arg(conflicts_with = "from")]
    pitches: Option<u32>,
    /// Volume of each guided run, as 20mL: the nearest whole pitches
    #[arg(long, value_name = "VOLUME", value_parser = units::volume_ml, conflicts_with_all = ["from", "pitches"])]
    volume: Option<f64>,
    /// Say which runs would be made and how long they take; move nothing and keep nothing
    #[arg(long)]
    dry_run: bool,
    /// Go on with a guided calibration that was begun: its readings are on record
    #[arg(long = "continue", conflicts_with_all = ["from", "anew"])]
    goes_on: bool,
    /// Give up the readings of a guided calibration that was begun, and begin again
    #[arg(long, conflicts_with = "from")]
    anew: bool,
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    balance: BalanceOptions,
    #[command(flatten)]
    fluid: FluidOptions,
    #[command(flatten)]
    bench: BenchOptions,
    #[command(flatten)]
    on_fail: OnFailOption,
    #[command(flatten)]
    format: FormatOption,
}

impl RunArgs {
    /// The command to run if this one fails; none for a dry run.
    pub(super) fn on_fail(&self) -> Option<OnFail> {
        if self.dry_run { None } else { self.on_fail.named(&self.bench.pump) }
    }

    pub(super) fn run(&self) -> Result<(), Failure> {
        self.reading.check()?;
        let mut file = self.bench.pump.file()?;
        self.fluid.change(&mut file)?;
        let bench = self.bench.bench_of(file)?;
        if self.from.is_some() && self.balance.is_given() {
            return Err(Failure::refused("--from has the readings of a table; leave out the balance"));
        }
        let Some(path) = &self.from else {
            let course = GuidedCourse {
                speeds_rad_s: self.speeds.clone(),
                each: self.runs,
                pitches: self.pitches,
                volume_ml: self.volume,
                dry_run: self.dry_run,
                goes_on: self.goes_on,
                anew: self.anew,
                temperature_degc: self.fluid.temperature,
                json: self.format.json(),
            };
            return match guided::runs(&bench, &course, Scale::of(&bench, &self.balance)?)? {
                Some(weighed) => self.guided(&bench, weighed),
                None if self.dry_run => Ok(()),
                None => tell(&format!("doses go on as before; {}\n", kept(&bench))),
            };
        };
        let steps_per_rev = bench.file().limits().motor.steps_per_rev;
        let runs = in_table(path, runs_of_csv(&read(path)?, steps_per_rev))?;
        let (stored, before) = self.keep(&bench, Source::File, runs, None)?;
        self.report(&bench, &stored, before.as_ref())
    }

    /// Keeps the calibration of guided runs, and removes their log.
    fn guided(&self, bench: &Bench, weighed: Weighed) -> Result<(), Failure> {
        let Weighed { runs, has_moved, digit_g } = weighed;
        let (stored, before) = match self.keep(bench, Source::Guided, runs, digit_g) {
            Ok(kept) => kept,
            Err(failure) => {
                let failure = if has_moved { failure.after_motion() } else { failure };
                return Err(failure.with(&format!("; {}", kept(bench))));
            }
        };
        RunLog::of(bench.folder()).end().map_err(|error| {
            let failure = Failure::failed(
                ErrorKind::Record,
                format!("calibration {} is kept and in use, but {}", stored.version, advice::told(&error)),
            );
            if has_moved { failure.after_motion() } else { failure }
        })?;
        self.report(bench, &stored, before.as_ref())
    }

    /// Fits the runs and has doses use what they show. It comes with the calibration that was in use until then.
    fn keep(
        &self,
        bench: &Bench,
        source: Source,
        runs: Vec<CalibrationRun>,
        digit_g: Option<f64>,
    ) -> Result<(Stored, Option<Stored>), Failure> {
        let _held = bench.folder().lock()?;
        let before = bench.calibrations().active()?;
        let used = before.as_ref().map(|active| &active.calibration);
        let expected = bench.with_drop(&self.reading.expected_of(bench, digit_g, &runs))?;
        let mut calibration = Calibration::of_runs(bench.file(), source, runs, self.fit, &expected, used)?;
        calibration.tube = self.reading.tube.clone();
        calibration.note = self.reading.note.clone();
        let stored = if self.dry_run {
            next_number(bench, calibration)?
        } else {
            bench.keep_calibration(calibration)?
        };
        Ok((stored, before))
    }

    fn report(&self, bench: &Bench, stored: &Stored, before: Option<&Stored>) -> Result<(), Failure> {
        if self.format.json() {
            return print_json(&calibration_json(bench, stored, before)?);
        }
        let kept = if self.dry_run { NOTHING_KEPT } else { "" };
        tell(&format!("{}{kept}", calibration_text(bench, stored, before, !self.dry_run, advice::words)?))
    }
}
