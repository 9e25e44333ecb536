//! Which pump, and where its record is.

use std::path::PathBuf;

use clap::Args;
use pump_bench::config::{Config, PumpPlace, config_path};
use pump_bench::pump_file::PumpFile;

use crate::failure::Failure;
use crate::told_commands::setup_that_was_left;

/// The configuration file.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pump and record")]
pub(crate) struct ConfigOption {
    /// Configuration file: pumps by name, and the folder of the record
    #[arg(
        long_help = "Configuration file (TOML): pumps by name, the pump of a command that names none, and the folder \
        of the record. Environment variable: DOSE_CONFIG. Default: pump-dose/config.toml in $XDG_CONFIG_HOME or in \
        ~/.config, and in the platform's folder on macOS and Windows. `dose config path` prints the place."
    )]
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
}

/// The pump.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pump and record")]
pub(crate) struct PumpOption {
    /// Pump: a name of the configuration, three-roller, two-roller or a pump file
    #[arg(
        long_help = "Pump file (TOML), name of the configuration, or built-in pump. Environment variable: \
        DOSE_PUMP. Default: the configuration's default_pump, and three-roller without one."
    )]
    #[arg(long, value_name = "NAME|FILE", env = "DOSE_PUMP", hide_env = true)]
    pump: Option<String>,
    #[command(flatten)]
    config: ConfigOption,
}

/// The folder of the record.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pump and record")]
pub(crate) struct RecordOption {
    /// Folder of the record
    #[arg(long_help = "Folder in which the angle, the carry and the calibrations of each pump are kept. \
        Environment variable: DOSE_STATE_DIR. Default: the configuration's state_dir, otherwise pump-dose in \
        $XDG_STATE_HOME or in ~/.local/state, on Windows in %LOCALAPPDATA%.")]
    #[arg(long, value_name = "DIR", env = "DOSE_STATE_DIR", hide_env = true)]
    state_dir: Option<PathBuf>,
}

/// The folder of the record, for a command that leaves the record alone: its files are no outputs.
#[derive(Debug, Args)]
pub(crate) struct ForeignRecord {
    #[arg(long, value_name = "DIR", env = "DOSE_STATE_DIR", hide = true)]
    state_dir: Option<PathBuf>,
}

impl ConfigOption {
    /// Reads the configuration.
    pub(crate) fn config(&self) -> Result<Config, Failure> {
        Config::of_user(self.config.as_deref()).map_err(Failure::of)
    }

    /// The path of the configuration file, whether it is there or not. None where the environment has no place for it.
    pub(crate) fn path(&self) -> Option<PathBuf> {
        self.config.clone().or_else(config_path)
    }
}

impl ForeignRecord {
    /// The folder in which records are kept, if there is one.
    pub(crate) fn folder(&self, config: &Config) -> Option<PathBuf> {
        self.state_dir.clone().or_else(|| config.state_dir().ok())
    }
}

impl PumpOption {
    /// Reads the configuration.
    pub(crate) fn config(&self) -> Result<Config, Failure> {
        self.config.config()
    }

    /// The path of the configuration file, whether it is there or not.
    pub(crate) fn config_path(&self) -> Option<PathBuf> {
        self.config.path()
    }

    /// The pump file, if a file is named or configured.
    pub(crate) fn path(&self) -> Result<Option<PathBuf>, Failure> {
        let config = self.config()?;
        let place = config.find(self.name(&config)).map_err(Failure::of)?;
        Ok(match place {
            PumpPlace::File(path) => Some(path),
            PumpPlace::BuiltIn(_) => None,
        })
    }

    /// Reads the pump that is named. A pump whose setup was left has no file yet.
    pub(crate) fn file(&self) -> Result<PumpFile, Failure> {
        let config = self.config()?;
        let name = self.name(&config);
        config.pump(name).map_err(|error| match setup_that_was_left(name) {
            Some(left) => Failure::of(error).with(&format!("; {left}")),
            None => Failure::of(error),
        })
    }

    /// The name of the pump as it was typed.
    pub(crate) fn typed(&self) -> Option<&str> {
        self.pump.as_deref()
    }

    /// The name of the pump: that of the option, or else the configuration's.
    pub(crate) fn name<'a>(&'a self, config: &'a Config) -> &'a str {
        self.pump.as_deref().unwrap_or(config.default_pump())
    }
}

impl RecordOption {
    /// The folder in which records are kept.
    pub(crate) fn folder(&self, config: &Config) -> Result<PathBuf, Failure> {
        match self.named()? {
            Some(dir) => Ok(dir),
            None => Ok(config.state_dir()?),
        }
    }

    /// The folder that the option or the environment names.
    pub(crate) fn named(&self) -> Result<Option<PathBuf>, Failure> {
        match &self.state_dir {
            Some(dir) if dir.as_os_str().is_empty() => Err(Failure::refused("--state-dir is empty")),
            dir => Ok(dir.clone()),
        }
    }
}
