//! The pumps that a name may mean: a path, a configured name or a built-in pump.

use std::path::{Path, PathBuf};

use super::error::ConfigError;
use super::file::Config;
use crate::catalogue::{BUILT_IN, built_in};
use crate::pump_file::{PumpFile, PumpFileError};

/// Pump of a command that names none, where no configuration does.
pub const DEFAULT_PUMP: &str = "three-roller";

/// Place of a pump's description.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PumpPlace {
    /// Built-in pump of this name.
    BuiltIn(&'static str),
    /// Pump file at this path.
    File(PathBuf),
}

impl PumpPlace {
    /// Returns the path of the pump file, or `None` for a built-in pump.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::BuiltIn(_) => None,
            Self::File(path) => Some(path),
        }
    }

    /// Reads the pump.
    ///
    /// # Errors
    /// [`PumpFileError`] of a file that cannot be used.
    pub fn read(&self) -> Result<PumpFile, PumpFileError> {
        match self {
            Self::BuiltIn(name) => Ok(built_in(name).unwrap_or_else(|| unreachable!("`{name}` is built in"))),
            Self::File(path) => PumpFile::read(path),
        }
    }
}

impl Config {
    /// Returns the name of the pump that a command takes if it names none.
    pub fn default_pump(&self) -> &str {
        self.default_pump.as_deref().unwrap_or(DEFAULT_PUMP)
    }

    /// Returns the name of the pump that the file gives to a command that names none. `None` if it gives none.
    pub fn named_default_pump(&self) -> Option<&str> {
        self.default_pump.as_deref()
    }

    /// Finds the pump of a name: a path, then a configured name, then a built-in pump, then a file in this folder.
    ///
    /// A name is a path if it has a `/` or a `\`, or ends in `.toml`.
    ///
    /// # Errors
    /// [`ConfigError::UnknownPump`], or [`PumpFileError::Unknown`] where no name is configured.
    pub fn find(&self, name: &str) -> Result<PumpPlace, ConfigError> {
        let path = Path::new(name);
        if name.contains(['/', '\\']) || name.ends_with(".toml") {
            return Ok(PumpPlace::File(path.to_owned()));
        }
        if let Some(file) = self.pumps.get(name) {
            return Ok(PumpPlace::File(file.clone()));
        }
        if let Some((known, _)) = BUILT_IN.iter().find(|(known, _)| *known == name) {
            return Ok(PumpPlace::BuiltIn(known));
        }
        if path.exists() {
            return Ok(PumpPlace::File(path.to_owned()));
        }
        let name = name.to_owned();
        Err(match self.path() {
            Some(path) if !self.pumps.is_empty() => ConfigError::UnknownPump {
                name,
                path: path.to_owned(),
                configured: self.pumps.keys().cloned().collect::<Vec<_>>().join(", "),
                built_in: built_in_names(),
            },
            _ => PumpFileError::Unknown { name, known: built_in_names() }.into(),
        })
    }

    /// Reads the pump of a name, as [`Config::find`] finds it.
    ///
    /// # Errors
    /// Errors of [`Config::find`] and [`PumpFile::read`]. [`ConfigError::SameId`] if another configured name leads to
    /// the same record.
    pub fn pump(&self, name: &str) -> Result<PumpFile, ConfigError> {
        let file = self.find(name)?.read()?;
        self.refuse_shared_record(name, &file)?;
        Ok(file)
    }

    /// Refuses a configured name whose record is that of another one. Other pumps whose files cannot be read have no
    /// record that could be shared.
    fn refuse_shared_record(&self, name: &str, file: &PumpFile) -> Result<(), ConfigError> {
        let Some(path) = self.pumps.get(name) else { return Ok(()) };
        let others = self.pumps.iter().filter(|(other, _)| *other != name);
        for (other, other_path) in others {
            if PumpFile::read(other_path).is_ok_and(|other| other.pump.id == file.pump.id) {
                return Err(ConfigError::SameId {
                    id: file.pump.id.clone(),
                    name: name.to_owned(),
                    file: path.clone(),
                    other: other.clone(),
                    other_file: other_path.clone(),
                });
            }
        }
        Ok(())
    }
}

/// Returns true for the name of a built-in pump.
pub(super) fn is_built_in(name: &str) -> bool {
    BUILT_IN.iter().any(|(known, _)| *known == name)
}

/// Returns the names of the built-in pumps.
pub(super) fn built_in_names() -> String {
    BUILT_IN.map(|(known, _)| known).join(", ")
}
