//! The readings that a person took: their uncertainty, and the tables that hold them.

use std::path::Path;

use clap::Args;
use pump_bench::Bench;
use pump_bench::calibration::{Calibration, CalibrationError, CalibrationRun, Expected, Stored};
use pump_bench::files::{MOST_TABLE_BYTES, read_text};
use pump_bench::pump_file::PumpFile;
use pump_bench::report::ErrorKind;
use pump_bench::units::{self, Amount, StatedReading};
use pump_model::Shown;

use super::scale::{digits_said, shown};
use crate::failure::Failure;
use crate::terminal::say;

/// Facts about the readings.
#[derive(Debug, Args)]
#[command(next_help_heading = "Readings")]
pub(super) struct ReadingOptions {
    /// Standard uncertainty of a reading of the scale or vessel, as 0.01g or 0.1mL
    #[arg(long, value_name = "MASS|VOLUME", value_parser = units::amount)]
    scale: Option<Amount>,
    /// Name of the tube, for the record
    #[arg(long, value_name = "NAME")]
    pub(super) tube: Option<String>,
    /// Note for the record
    #[arg(long, value_name = "TEXT")]
    pub(super) note: Option<String>,
}

/// Largest uncertainty of a reading, g or mL: more is a mistake in the unit.
const MOST_SCALE: f64 = 1000.0;

impl ReadingOptions {
    /// Refuses an uncertainty that cannot be meant, before anything is weighed.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let (value, unit) = match self.scale {
            None => return Ok(()),
            Some(Amount::Mass(mass_g)) => (mass_g, "g"),
            Some(Amount::Volume(volume_ml)) => (volume_ml, "mL"),
        };
        if value > 0.0 && value <= MOST_SCALE {
            return Ok(());
        }
        let value = format!("{} {unit}", Shown(value));
        let allowed = format!("more than 0 {unit}, {MOST_SCALE} {unit} at most");
        let message =
            format!("--scale is {value}; allowed: {allowed}; write how unsure a reading is, as 0.01g");
        Err(Failure::refused(message).kind(ErrorKind::Range).value(value).allowed(allowed))
    }

    /// True if the uncertainty of a reading is given.
    pub(super) fn has_scale(&self) -> bool {
        self.scale.is_some()
    }

    /// The scatter that is expected of the readings of a balance with this step of its last digit, in g, or of those of
    /// a person, whose finest digit counts. `--scale` wins, and without it the step of a balance is said.
    pub(super) fn expected_of(
        &self,
        bench: &Bench,
        digit_g: Option<f64>,
        runs: &[CalibrationRun],
    ) -> Expected {
        if self.has_scale() {
            return self.expected(bench.file());
        }
        let Some(digit_g) = digit_g else { return Expected::of_runs(bench.file(), runs) };
        say(&format!(
            "the balance shows steps of {}{}\n",
            shown(digit_g, digit_g),
            digits_said(digit_g, false)
        ));
        let reading = StatedReading { amount: Amount::Mass(digit_g), resolution: Amount::Mass(digit_g) };
        Expected::of_digits(bench.file(), &reading)
    }

    /// The scatter that is expected of the readings of the fluid of a pump file.
    pub(super) fn expected(&self, file: &PumpFile) -> Expected {
        // The buoyancy of a difference between readings is nothing beside its uncertainty.
        let reading_ml = self.scale.map_or(0.0, |scale| scale.volume_ml(file.fluid.density_kg_m3));
        Expected::of(file, reading_ml)
    }
}

/// The words that follow a calibration of a dry run.
pub(super) const NOTHING_KEPT: &str = "nothing is kept: this was a dry run\n";

/// Gives a calibration the number that it would be kept under.
pub(super) fn next_number(bench: &Bench, calibration: Calibration) -> Result<Stored, CalibrationError> {
    let kept = bench.calibrations().list()?;
    Ok(Stored::new(kept.last().map_or(1, |last| last.version + 1), calibration))
}

/// Reads a table that a person wrote.
pub(super) fn read(path: &Path) -> Result<String, Failure> {
    read_text(path, MOST_TABLE_BYTES).map_err(|error| Failure::unread(path, &error))
}

/// Says in which table an error is.
pub(super) fn in_table<T>(path: &Path, found: Result<T, CalibrationError>) -> Result<T, Failure> {
    found.map_err(|error| Failure::of(error).after(&format!("{}: ", path.display())))
}
