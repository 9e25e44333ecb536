//! The readings that a person took: their uncertainty, and the tables that hold them.

use std::path::Path;

use clap::Args;
use pump_bench::Bench;
use pump_bench::calibration::{CalibrationError, Expected};
use pump_bench::units::{self, Amount};

use crate::failure::Failure;

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

impl ReadingOptions {
    /// The scatter that is expected of the readings of a bench.
    pub(super) fn expected(&self, bench: &Bench) -> Result<Expected, Failure> {
        let file = bench.file();
        let reading_ml = self.scale.map_or(0.0, |scale| scale.volume_ml(file.fluid.density_kg_m3));
        if reading_ml < 0.0 {
            return Err(Failure::refused("--scale is negative; write how unsure a reading is, as 0.01g"));
        }
        Ok(Expected::of(file, reading_ml))
    }
}

/// Reads a table that a person wrote.
pub(super) fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path)
        .map_err(|error| Failure::refused(format!("cannot read {}: {error}", path.display())))
}

/// Says in which table an error is.
pub(super) fn in_table<T>(path: &Path, found: Result<T, CalibrationError>) -> Result<T, Failure> {
    found.map_err(|error| Failure::refused(format!("{}: {error}", path.display())))
}
