//! `dose calibrate last`: the weight of the dose just made calibrates the next one.

use clap::Args;
use pump_bench::Bench;
use pump_bench::calibration::{Earlier, Expected, Stored};
use pump_bench::pump_file::PumpFile;
use pump_bench::record::DosedFluid;
use pump_bench::report::{calibration_json, calibration_text};
use pump_bench::units::{Amount, StatedReading, stated_reading};

use super::reading::{NOTHING_KEPT, ReadingOptions, next_number};
use super::scale::{digits_said, shown as shown_mass};
use crate::advice;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::balance::{BalanceOptions, read_still};
use crate::options::bench::RecordOptions;
use crate::options::fluid::FluidOptions;
use crate::options::motor::PortOption;
use crate::options::report::FormatOption;
use crate::terminal::{print_json, say, tell};

#[derive(Debug, Args)]
pub(super) struct LastArgs {
    /// Reading of the scale or vessel for the last dose, as 23.8g or 24mL. Without --scale, its last digit says how
    /// sure it is
    #[arg(value_name = "READING", value_parser = stated_reading)]
    #[arg(required_unless_present_any = ["volume", "scale_port", "scale_command"])]
    #[arg(conflicts_with_all = ["volume", "scale_port", "scale_command"])]
    reading: Option<StatedReading>,
    /// Volume that a measuring vessel shows, as 24mL, in place of READING
    #[arg(long, value_name = "VOLUME", value_parser = stated_volume)]
    #[arg(conflicts_with_all = ["scale_port", "scale_command"])]
    volume: Option<StatedReading>,
    /// Dose that was weighed, by its number in `dose log` or by the order of `dose serve` that made it. The reading is
    /// refused if another dose came since
    #[arg(long, value_name = "NUMBER")]
    dose: Option<String>,
    #[command(flatten)]
    balance: BalanceOptions,
    /// Join the reading to the runs of the calibration in use, whatever made them
    #[arg(long)]
    add: bool,
    /// Calibrate by this reading alone
    #[arg(long, conflicts_with = "add")]
    anew: bool,
    /// Take a reading that lies far beyond the ± of the dose
    #[arg(long)]
    anyway: bool,
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
    port: PortOption,
    #[command(flatten)]
    format: FormatOption,
}

/// Reads the volume that a measuring vessel shows.
fn stated_volume(text: &str) -> Result<StatedReading, String> {
    let reading = stated_reading(text).map_err(|error| error.to_string())?;
    match reading.amount {
        Amount::Volume(_) => Ok(reading),
        Amount::Mass(_) => Err(format!("`{text}` is a mass; write it without --volume")),
    }
}

impl LastArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        self.options.check()?;
        let bench = self.record.bench_of(self.record.pump.file()?, Some(&self.port))?;
        let _held = bench.folder().lock()?;
        if let Some(dose) = &self.dose {
            bench.check_is_last_dose(dose)?;
        }
        let file = self.file(&bench)?;
        let reading = self.reading(&bench)?;
        let expected = if self.options.has_scale() {
            self.options.expected(&file)
        } else {
            Expected::of_digits(&file, &reading)
        };
        let weighed = bench.weigh_last_dose(&file, &reading, self.earlier(), &expected)?;
        if !self.anyway {
            let likely = weighed.check_likely().map_err(Failure::of);
            likely.map_err(|failure| failure.with("; if it is right, add --anyway"))?;
        }
        if let Some(replaced) = weighed.replaced {
            say(&format!("this reading takes the place of {replaced} of the same dose\n"));
        }
        if let Some(by_angle_ml) = weighed.by_angle_ml {
            say(&format!(
                "the rollers' angle was not known to better than 2 deg: it leaves the volume of this dose uncertain by \
                 ± {by_angle_ml:.4} mL (k = 2)\n"
            ));
        }
        let mut calibration = weighed.calibration;
        calibration.tube = self.options.tube.clone().or(calibration.tube);
        calibration.note = self.options.note.clone();
        let before = bench.calibrations().active()?;
        let stored = if self.dry_run {
            next_number(&bench, calibration)?
        } else {
            bench.keep_weighing(calibration)?
        };
        self.report(&bench, &stored, before.as_ref())
    }

    /// The pump file with the fluid that was weighed: that of the dose, unless the options name another. A difference
    /// to the pump file or the record is said.
    fn file(&self, bench: &Bench) -> Result<PumpFile, Failure> {
        let (name, degc) = self.fluid.named();
        let file = bench.file_of_last_dose(name.as_deref(), degc)?;
        let dosed = bench.last_dose()?.and_then(|dose| dose.fluid);
        let fluid = &file.fluid;
        if let Some(dosed) = dosed {
            let weighed = DosedFluid::of(fluid);
            if !dosed.is_of(fluid) {
                say(&format!("the dose was made as {dosed}, and its reading is taken as {weighed}\n"));
            } else if !dosed.is_of(&bench.file().fluid) {
                say(&format!("the dose was {dosed}, and its reading is taken as that\n"));
            }
        }
        Ok(file)
    }

    /// The reading that was typed, or that of the balance once it stands still. The balance was tared with the empty
    /// vessel before the dose.
    fn reading(&self, bench: &Bench) -> Result<StatedReading, Failure> {
        if let Some(reading) = self.reading.or(self.volume) {
            return Ok(reading);
        }
        let missing = || Failure::refused("what does the scale show? Write it, as 23.8g, or name a balance");
        let mut balance = self.balance.open(bench.board_port())?.ok_or_else(missing)?;
        let _interrupt = Interrupt::watch()?;
        let shown = read_still(balance.as_mut(), self.balance.longest_wait())?;
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

    fn report(&self, bench: &Bench, stored: &Stored, before: Option<&Stored>) -> Result<(), Failure> {
        if self.format.json() {
            return print_json(&calibration_json(bench, stored, before)?);
        }
        let text = calibration_text(bench, stored, before, !self.dry_run, advice::words)?;
        let kept = if self.dry_run { NOTHING_KEPT } else { "" };
        tell(&format!("{text}{kept}"))
    }
}
