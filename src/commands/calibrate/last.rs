//! `dose calibrate last`: the weight of the dose just made calibrates the next one.

use clap::Args;
use libm::sqrt;
use pump_bench::Bench;
use pump_bench::calibration::{CalibrationRun, Displacement, Earlier, Expected, Stored, WeighedDose};
use pump_bench::report::{calibration_json, calibration_text};
use pump_bench::units::{Amount, StatedReading, stated_reading};
use pump_model::identification::widening;

use super::reading::{NOTHING_KEPT, ReadingOptions, next_number};
use super::scale::{digits_said, shown as shown_mass, still};
use crate::advice;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::balance::BalanceOptions;
use crate::options::bench::RecordOptions;
use crate::options::fluid::FluidOptions;
use crate::options::report::FormatOption;
use crate::terminal::{print, say, tell};

/// Part of the uncertainty that more doses must leave at most, so that they are worth their time.
const SURER: f64 = 0.9;

/// Most doses that the command asks for.
const MOST_MORE: usize = 9;

#[derive(Debug, Args)]
pub(super) struct LastArgs {
    /// Reading of the scale or vessel for the last dose, as 23.8g or 24mL. Without --scale, its last digit says how
    /// sure it is
    #[arg(value_name = "READING", value_parser = stated_reading)]
    #[arg(required_unless_present_any = ["scale_port", "scale_command"])]
    #[arg(conflicts_with_all = ["scale_port", "scale_command"])]
    reading: Option<StatedReading>,
    #[command(flatten)]
    balance: BalanceOptions,
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
        let reading = self.reading()?;
        let expected = if self.options.has_scale() {
            self.options.expected(&bench)
        } else {
            Expected::of_digits(bench.file(), &reading)
        };
        let weighed = bench.weigh_last_dose(&reading, self.fluid.temperature, self.earlier(), &expected)?;
        let WeighedDose { run, mut calibration, .. } = weighed;
        calibration.tube = self.options.tube.clone().or(calibration.tube);
        calibration.note = self.options.note.clone();
        let stored = if self.dry_run {
            next_number(&bench, calibration)?
        } else {
            bench.keep_calibration(calibration)?
        };
        self.report(&bench, &stored, &run)
    }

    /// The reading that was typed, or that of the balance once it stands still. The balance was tared with the empty
    /// vessel before the dose.
    fn reading(&self) -> Result<StatedReading, Failure> {
        if let Some(reading) = self.reading {
            return Ok(reading);
        }
        let missing = || Failure::refused("what does the scale show? Write it, as 23.8g, or name a balance");
        let mut balance = self.balance.open()?.ok_or_else(missing)?;
        let _interrupt = Interrupt::watch()?;
        let shown = still(balance.as_mut(), self.balance.longest_wait())?;
        let text = shown_mass(shown.mass_g, shown.step_g);
        if shown.mass_g <= 0.0 {
            return Err(Failure::refused(format!(
                "the balance shows {text}; tare it with the empty vessel before the dose, and weigh after it"
            )));
        }
        say(&format!("the balance shows {text}{}\n", digits_said(shown.step_g, self.options.has_scale())));
        Ok(StatedReading { amount: Amount::Mass(shown.mass_g), resolution: Amount::Mass(shown.step_g) })
    }

    fn earlier(&self) -> Earlier {
        match (self.add, self.anew) {
            (true, _) => Earlier::Added,
            (_, true) => Earlier::Left,
            _ => Earlier::Joined,
        }
    }

    fn report(&self, bench: &Bench, stored: &Stored, run: &CalibrationRun) -> Result<(), Failure> {
        if self.format.json() {
            return print(&calibration_json(bench, stored)?);
        }
        let text = calibration_text(bench, stored, advice::words)?;
        let next = next_weighing(bench, stored, run)?;
        let kept = if self.dry_run { NOTHING_KEPT } else { "" };
        tell(&format!("{text}{next}{kept}"))
    }
}

/// Says how sure the volumes are now, and how many more doses like this one make them surer.
pub(in crate::commands) fn next_weighing(
    bench: &Bench,
    stored: &Stored,
    run: &CalibrationRun,
) -> Result<String, Failure> {
    let Some(found) = &stored.calibration.displacement else { return Ok(String::new()) };
    let standard = found.whole_standard_at(bench.model(), run.speed_rpm).map_err(Failure::of)?;
    let percent = |standard: f64| format!("{:.2} %", 200.0 * standard / found.factor);
    let mut text = format!(
        "volumes at this speed are now sure to ± {} (k = 2), before the scatter of a single dose",
        percent(standard)
    );
    let weighed = stored.calibration.runs.len();
    let expected = standards_of_more(found, standard, weighed);
    if let Some((more, standard)) = expected.into_iter().find(|(_, then)| *then < SURER * standard) {
        let doses = if more == 1 { "one more dose".to_owned() } else { format!("{more} more doses") };
        text += &format!("; {doses}, weighed as this one, will bring about ± {}", percent(standard));
    }
    Ok(text + "\n")
}

/// The standard uncertainties of the factor that more weighed doses are expected to bring, each with its number of
/// doses. So few doses show their scatter badly, and Student's t widens it (GUM, table G.2): a second one alone brings
/// nothing.
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
