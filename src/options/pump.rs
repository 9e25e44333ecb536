//! Which pump, and where its record is.

use std::path::{Path, PathBuf};

use clap::Args;
use pump_bench::pump_file::PumpFile;
use pump_bench::record::default_state_dir;
use pump_bench::{built_in, pump_named};

use crate::failure::Failure;

/// The pump.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pump and record")]
pub(crate) struct PumpOption {
    /// Pump: three-roller, two-roller or a pump file
    #[arg(long_help = "Built-in pump or pump file (TOML). Environment variable: DOSE_PUMP. Default: \
        three-roller.")]
    #[arg(long, value_name = "NAME|FILE", env = "DOSE_PUMP", default_value = "three-roller")]
    #[arg(hide_env = true, hide_default_value = true)]
    pump: String,
}

/// The folder of the record.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pump and record")]
pub(crate) struct RecordOption {
    /// Folder of the record
    #[arg(long_help = "Folder in which the angle, the carry and the calibrations of each pump are kept. \
        Environment variable: DOSE_STATE_DIR. Default: pump-dose in $XDG_STATE_HOME or in \
        ~/.local/state.")]
    #[arg(long, value_name = "DIR", env = "DOSE_STATE_DIR", hide_env = true)]
    state_dir: Option<PathBuf>,
}

/// The folder of the record, for a command that leaves the record alone: its files are no outputs.
#[derive(Debug, Args)]
pub(crate) struct ForeignRecord {
    #[arg(long, value_name = "DIR", env = "DOSE_STATE_DIR", hide = true)]
    state_dir: Option<PathBuf>,
}

impl ForeignRecord {
    /// The folder in which records are kept, if there is one.
    pub(crate) fn folder(&self) -> Option<PathBuf> {
        self.state_dir.clone().or_else(|| default_state_dir().ok())
    }
}

impl PumpOption {
    /// The pump file, if a file is named.
    pub(crate) fn path(&self) -> Option<&Path> {
        built_in(&self.pump).is_none().then(|| Path::new(&self.pump))
    }

    /// Reads the pump that is named.
    pub(crate) fn file(&self) -> Result<PumpFile, Failure> {
        pump_named(&self.pump).map_err(Failure::of)
    }
}

impl RecordOption {
    /// The folder in which records are kept.
    pub(crate) fn folder(&self) -> Result<PathBuf, Failure> {
        match &self.state_dir {
            Some(dir) if dir.as_os_str().is_empty() => Err(Failure::refused("--state-dir is empty")),
            Some(dir) => Ok(dir.clone()),
            None => Ok(default_state_dir()?),
        }
    }
}
