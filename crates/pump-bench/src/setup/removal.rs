//! A pump that is given up: its name leaves the configuration, and its file the folder.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::error::SetupError;
use super::folder::{SetupFolder, write};
use crate::config::{Config, ConfigError};
use crate::files::{MOST_PUMP_FILE_BYTES, read_text};

/// Pump that was removed, with the files that are gone and those that stay.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct RemovedPump {
    /// Pump file that the name led to.
    pub file: PathBuf,
    /// True if the file was deleted. A file outside the configuration's folder of pumps stays, and so does one that
    /// another name leads to.
    pub deleted: bool,
    /// Answers of the pump's setup that stay, so that the setup writes the file again. `None` without any, and for a
    /// setup that was left before anything is on record, whose answers are deleted.
    pub answers: Option<PathBuf>,
}

impl SetupFolder {
    /// Removes the pump `name`: its line in the configuration, then its file. The record of its doses stays. If
    /// `has_record`, the answers of its setup stay too: without them no setup may go on with that record.
    ///
    /// # Errors
    /// [`SetupError::Config`] if the configuration has no such pump, or no line of its own for it; nothing has changed
    /// then. [`SetupError::File`] if a file cannot be read, written or deleted.
    pub fn remove_pump(&self, name: &str, has_record: bool) -> Result<RemovedPump, SetupError> {
        let failed = |action: &'static str, path: &Path| {
            let path = path.to_owned();
            move |source| SetupError::File { action, path, source }
        };
        let text = read_text(&self.config, MOST_PUMP_FILE_BYTES).map_err(failed("read", &self.config))?;
        let before = Config::parse(&text, &self.config)?;
        let no_line = || ConfigError::NoLine { path: self.config.clone(), name: name.to_owned() };
        let file = before.pumps().get(name).ok_or_else(no_line)?.clone();
        let without = Config::without_pump(&text, &self.config, name)?;
        let is_named_twice = before.pumps().iter().any(|(other, path)| other != name && *path == file);
        write(&self.config, &without)?;
        let own = self.pump_file(name);
        let own = std::path::absolute(&own).unwrap_or(own);
        let deleted = !is_named_twice && file == own && delete(&file).map_err(failed("delete", &file))?;
        let answers = self.answers(name);
        let is_left =
            !has_record && self.read(name).ok().flatten().is_some_and(|answers| !answers.is_finished());
        if is_left {
            delete(&answers).map_err(failed("delete", &answers))?;
        }
        let stay = Some(answers).filter(|answers| answers.exists());
        Ok(RemovedPump { file, deleted, answers: stay })
    }
}

/// Deletes a file. False if there is none.
fn delete(path: &Path) -> std::io::Result<bool> {
    match fs::remove_file(path) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}
