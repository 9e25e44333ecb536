//! The configuration as it is in force: pumps, default pump and records.

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::config::{Config, DoseDefaults};
use crate::notice::with_sources;
use crate::record::FolderError;

/// Schema of the JSON.
const SCHEMA: &str = "config/1";

/// The configuration that is in force.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct ShownConfig {
    /// Schema of the JSON, `config/1`.
    pub schema: &'static str,
    /// Path of the configuration file. `None` if the environment has no place for it.
    pub path: Option<PathBuf>,
    /// True if there is a file.
    pub exists: bool,
    /// Pump of a command that names none.
    pub default_pump: String,
    /// Folder of the records.
    pub state_dir: PathBuf,
    /// Shell's command that is run once a dose fails. `None` without one.
    pub on_fail: Option<String>,
    /// Options of a dose that the configuration sets.
    pub defaults: DoseDefaults,
    /// Pumps of the configuration, in the order of their names.
    pub pumps: Vec<ShownPump>,
    /// Racks of the configuration, in the order of their names.
    pub racks: Vec<ShownRack>,
}

/// A rack of the configuration.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct ShownRack {
    /// Name of the rack.
    pub name: String,
    /// File of the rack.
    pub file: PathBuf,
}

/// A pump of the configuration.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct ShownPump {
    /// Name of the pump.
    pub name: String,
    /// Pump file.
    pub file: PathBuf,
    /// Identifier of the pump, which names its record. `None` if the pump cannot be used.
    pub id: Option<String>,
    /// Reason why the pump cannot be used.
    pub error: Option<String>,
}

impl ShownConfig {
    /// Reads the configured pumps. `state_dir` is the folder of the records if it is named elsewhere.
    ///
    /// # Errors
    /// [`FolderError::NoFolder`] if no folder for records is known.
    pub fn of(config: &Config, state_dir: Option<&Path>) -> Result<Self, FolderError> {
        let state_dir = state_dir.map_or_else(|| config.state_dir(), |dir| Ok(dir.to_owned()))?;
        Ok(Self {
            schema: SCHEMA,
            path: config.path().map(Path::to_owned),
            exists: config.exists(),
            default_pump: config.default_pump().to_owned(),
            state_dir,
            on_fail: config.on_fail().map(str::to_owned),
            defaults: config.defaults().clone(),
            pumps: ShownPump::all(config),
            racks: ShownRack::all(config),
        })
    }

    /// Returns the configuration as one line of JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("plain texts: {error}"))
    }

    /// Returns the configuration in words.
    pub fn text(&self) -> String {
        let path = match &self.path {
            Some(path) if self.exists => path.display().to_string(),
            Some(path) => format!("{} (no file is there)", path.display()),
            None => "none: neither HOME nor XDG_CONFIG_HOME is set".to_owned(),
        };
        let (default, records) = (&self.default_pump, self.state_dir.display());
        let on_fail =
            self.on_fail.as_ref().map_or(String::new(), |command| format!("on failure     {command}\n"));
        let options: Vec<_> =
            self.defaults.all().map(|(key, value)| format!("--{} {value}", key.replace('_', "-"))).collect();
        let defaults = match options[..] {
            [] => String::new(),
            _ => format!("defaults       {}\n", options.join(" ")),
        };
        let pumps: String = self.pumps.iter().map(ShownPump::line).collect();
        let racks: String = self.racks.iter().map(ShownRack::line).collect();
        format!(
            "configuration  {path}\ndefault pump   {default}\nrecords        {records}\n{on_fail}{defaults}{pumps}\
             {racks}"
        )
    }
}

impl ShownRack {
    fn all(config: &Config) -> Vec<Self> {
        let shown = |(name, file): (&String, &PathBuf)| Self { name: name.clone(), file: file.clone() };
        config.racks().iter().map(shown).collect()
    }

    fn line(&self) -> String {
        format!("{:<24}{}, a rack\n", self.name, self.file.display())
    }
}

impl ShownPump {
    /// Reads the pumps of a configuration, in the order of their names.
    pub fn all(config: &Config) -> Vec<Self> {
        let shown = |(name, file): (&String, &PathBuf)| {
            let read = config.pump(name);
            let error = read.as_ref().err().map(|error| with_sources(error));
            Self { name: name.clone(), file: file.clone(), id: read.ok().map(|file| file.pump.id), error }
        };
        config.pumps().iter().map(shown).collect()
    }

    /// Returns the pump as a line of words.
    pub fn line(&self) -> String {
        let file = self.file.display();
        match (&self.id, &self.error) {
            (Some(id), _) => format!("{:<24}{file}, id {id}\n", self.name),
            // A parser's message has several lines.
            (None, error) => {
                let error = error.as_deref().unwrap_or_default().lines().next().unwrap_or_default();
                format!("{:<24}{file}, cannot be used: {error}\n", self.name)
            }
        }
    }
}
