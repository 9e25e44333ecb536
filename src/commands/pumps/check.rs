//! `dose pumps check`: a pump file, or a built-in pump, is checked.

use clap::Args;
use pump_bench::Bench;
use pump_bench::config::{ConfigError, PumpPlace};
use pump_bench::pump_file::PumpFileError;
use pump_bench::report::pump_check;

use crate::failure::Failure;
use crate::options::pump::{ConfigOption, RecordOption};
use crate::terminal::tell;

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// Pump file (TOML), a name of the configuration, or a built-in pump
    #[arg(value_name = "FILE|NAME")]
    file: String,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    record: RecordOption,
}

impl CheckArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let config = self.config.config()?;
        let place = config.find(&self.file).or_else(|error| match error {
            // A file that is not there is a missing file, whatever its name.
            ConfigError::Pump(PumpFileError::Unknown { .. }) => {
                Ok(PumpPlace::File(self.file.as_str().into()))
            }
            error => Err(Failure::of(error)),
        })?;
        let file = place.read().map_err(Failure::of)?;
        if let Some(path) = place.file() {
            file.check_port(&path.display().to_string()).map_err(Failure::of)?;
        }
        // Where no place for records is known there are no calibrations either.
        let Ok(folder) = self.record.folder(&config) else {
            return tell(&pump_check(&file, None).map_err(Failure::of)?);
        };
        let bench = Bench::new(file, None, &folder)?;
        let used = bench.calibrations().active().map_err(Failure::of)?;
        tell(&pump_check(bench.file(), used.as_ref()).map_err(Failure::of)?)
    }
}
