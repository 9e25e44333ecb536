//! `dose calibrate last`: the weight of the dose just made calibrates the next one.

use clap::Args;
use pump_bench::Bench;
use pump_bench::calibration::{
    Calibration, CalibrationRun, Displacement, Earlier, Expected, Source, Stored, WeighedDose, fit_of_doses,
};
use pump_bench::report::{calibration_json, calibration_text};
use pump_bench::units::{StatedReading, stated_reading};

use super::reading::{NOTHING_KEPT, ReadingOptions, next_number};
use crate::advice;
use crate::failure::Failure;
use crate::options::bench::RecordOptions;
use crate::options::fluid::FluidOptions;
use crate::options::report::FormatOption;
use crate::terminal::{print, tell};

#[derive(Debug, Args)]
pub(super) struct LastArgs {
    /// Reading of the scale or vessel for the last dose, as 23.8g or 24mL. Without --scale, its last digit says how
    /// sure it is
    #[arg(value_name = "READING", value_parser = stated_reading)]
    reading: StatedReading,
    /// Join the reading to the runs of the calibration in use, whatever made them
    #[arg(long)]
    add: bool,
    /// Calibrate by this reading alone
    #[arg(long, conflicts_with = "add")]
    anew: bool,
    /// Say what the reading shows, and keep nothing
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    options: ReadingOptions,
    #[command(flatten)]
    fluid: FluidOptions,
    #[command(flatten)]
    record: RecordOptions,
    #[command(flatten)]
    format: FormatOption,
}

impl LastArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        self.options.check()?;
        let mut file = self.record.pump.file()?;
        self.fluid.change(&mut file)?;
        let bench = self.record.bench_of(file, None)?;
        let _held = bench.folder().lock()?;
        let expected = if self.options.has_scale() {
            self.options.expected(&bench)
        } else {
            Expected::of_digits(bench.file(), &self.reading)
        };
        let weighed =
            bench.weigh_last_dose(&self.reading, self.fluid.temperature, self.earlier(), &expected)?;
        let WeighedDose { run, mut calibration, .. } = weighed;
        calibration.tube = self.options.tube.clone().or(calibration.tube);
        calibration.note = self.options.note.clone();
        let stored = if self.dry_run {
            next_number(&bench, calibration)?
        } else {
            bench.keep_calibration(calibration)?
        };
        self.report(&bench, &stored, &run, &expected)
    }

    fn earlier(&self) -> Earlier {
        match (self.add, self.anew) {
            (true, _) => Earlier::Added,
            (_, true) => Earlier::Left,
            _ => Earlier::Joined,
        }
    }

    fn report(
        &self,
        bench: &Bench,
        stored: &Stored,
        run: &CalibrationRun,
        expected: &Expected,
    ) -> Result<(), Failure> {
        if self.format.json() {
            return print(&calibration_json(bench, stored)?);
        }
        let text = calibration_text(bench, stored, advice::words)?;
        let next = next_weighing(bench, stored, run, expected)?;
        let kept = if self.dry_run { NOTHING_KEPT } else { "" };
        tell(&format!("{text}{next}{kept}"))
    }
}

/// Says what one more dose like this one would bring, weighed as closely.
fn next_weighing(
    bench: &Bench,
    stored: &Stored,
    run: &CalibrationRun,
    expected: &Expected,
) -> Result<String, Failure> {
    let Some(now) = &stored.calibration.displacement else { return Ok(String::new()) };
    let mut runs = stored.calibration.runs.clone();
    runs.push(run.clone());
    let before = Some(&stored.calibration);
    let fit = fit_of_doses(&runs);
    let then = Calibration::of_runs(bench.file(), Source::Last, runs, fit, expected, before)?;
    let Some(then) = &then.displacement else { return Ok(String::new()) };
    let percent = |found: &Displacement| -> Result<f64, Failure> {
        let standard = found.whole_standard_at(bench.model(), run.speed_rpm).map_err(Failure::of)?;
        Ok(200.0 * standard / found.factor)
    };
    let (now_percent, then_percent) = (percent(now)?, percent(then)?);
    if then_percent >= now_percent {
        return Ok(String::new());
    }
    Ok(format!(
        "volumes at this speed are now sure to ± {now_percent:.2} % (k = 2), before the scatter of a single dose; \
         one more dose, weighed as this one, brings ± {then_percent:.2} %\n"
    ))
}
