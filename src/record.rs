//! What a pump remembers between doses: where its rollers stand and what it owes.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};

use pump_model::math::TURN_RAD;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::output::replace_file;

const SCHEMA: &str = "record/1";
const RECORD: &str = "record.json";
const LOCK: &str = "lock";

/// Angle and carry of a pump under one driver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    schema: String,
    /// Angle of the rotor in the model's zero, rad, in [0, 2 pi).
    pub angle_rad: f64,
    /// The true angle lies within this of it, rad.
    pub half_width_rad: f64,
    /// What earlier doses owe, mL, positive toward the outlet.
    pub carry_ml: f64,
}

impl Record {
    /// A rotor within `half_width_rad` of `angle_rad` that owes `carry_ml`.
    pub fn new(angle_rad: f64, half_width_rad: f64, carry_ml: f64) -> Self {
        let angle_rad = pump_model::math::wrap(angle_rad, TURN_RAD);
        Self { schema: SCHEMA.to_owned(), angle_rad, half_width_rad, carry_ml }
    }
}

/// A record that cannot be read, kept or locked.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordError {
    /// Another process doses with this pump.
    #[error("pump `{pump}` is in use by {holder}; wait until it is done (lock file {})", .path.display())]
    Busy {
        /// Pump id.
        pump: String,
        /// What the lock says of its holder.
        holder: String,
        /// The lock file.
        path: PathBuf,
    },
    /// A file or folder cannot be used.
    #[error("cannot {action} {}: {source}; choose another folder with --state-dir or DOSE_STATE_DIR", .path.display())]
    File {
        /// What was tried.
        action: &'static str,
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The record is there but says nothing usable.
    #[error(
        "the record {} is damaged: {message}; the rotor's angle is not known: say where it stands with --start-angle",
        .path.display()
    )]
    Damaged {
        /// Which file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// No place for records is known.
    #[error(
        "no folder for records: neither XDG_STATE_HOME nor HOME is set; name one with --state-dir or DOSE_STATE_DIR"
    )]
    NoFolder,
}

/// The folder `<state dir>/<pump id>/<driver>/`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folder {
    path: PathBuf,
    pump: String,
}

/// Where records are kept unless told otherwise: `$XDG_STATE_HOME/pump-dose` or `~/.local/state/pump-dose`.
pub fn default_state_dir() -> Result<PathBuf, RecordError> {
    let set = |name| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let base = set("XDG_STATE_HOME").or_else(|| set("HOME").map(|home| home.join(".local").join("state")));
    Ok(base.ok_or(RecordError::NoFolder)?.join("pump-dose"))
}

impl Folder {
    /// The folder of a pump under a driver; nothing is created yet.
    pub fn new(state_dir: &Path, pump: &str, driver: &str) -> Self {
        Self { path: state_dir.join(pump).join(driver), pump: pump.to_owned() }
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The record; none if there has never been one.
    pub fn read(&self) -> Result<Option<Record>, RecordError> {
        let path = self.path.join(RECORD);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => {
                return Err(RecordError::File { action: "read", path, source });
            }
        };
        let record: Record = match serde_json::from_str(&text) {
            Ok(record) => record,
            Err(error) => {
                return Err(RecordError::Damaged { path, message: error.to_string() });
            }
        };
        let sound = record.schema == SCHEMA
            && record.angle_rad.is_finite()
            && record.half_width_rad >= 0.0
            && record.carry_ml.is_finite();
        if sound {
            Ok(Some(record))
        } else {
            Err(RecordError::Damaged { path, message: format!("unexpected contents {text}") })
        }
    }

    /// Creates the folder and takes the pump for this process until the lock is dropped.
    pub fn lock(&self) -> Result<Lock, RecordError> {
        let failed = |action, path: &Path| {
            let path = path.to_owned();
            move |source| RecordError::File { action, path, source }
        };
        fs::create_dir_all(&self.path).map_err(failed("create the folder", &self.path))?;
        let path = self.path.join(LOCK);
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(failed("write", &path))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut holder = String::new();
                // On some systems a locked file cannot be read; the refusal stands all the same.
                let read = file.read_to_string(&mut holder).is_ok() && !holder.trim().is_empty();
                let holder = if read { holder.trim().to_owned() } else { "another process".to_owned() };
                return Err(RecordError::Busy { pump: self.pump.clone(), holder, path });
            }
            Err(TryLockError::Error(source)) => {
                return Err(RecordError::File { action: "lock", path, source });
            }
        }
        let holder = format!("process {}\n", std::process::id());
        file.set_len(0)
            .and_then(|()| file.rewind())
            .and_then(|()| file.write_all(holder.as_bytes()))
            .map_err(failed("write", &path))?;
        Ok(Lock { folder: self.clone(), _file: file })
    }
}

/// The right to move a pump and to change its record.
#[derive(Debug)]
pub struct Lock {
    folder: Folder,
    _file: File,
}

impl Lock {
    /// Replaces the record: the old one or the new one is there at any instant.
    pub fn write(&self, record: &Record) -> Result<(), RecordError> {
        let path = self.folder.path.join(RECORD);
        let failed = |source| RecordError::File { action: "write", path: path.clone(), source };
        let mut text = serde_json::to_vec_pretty(record).map_err(|error| failed(error.into()))?;
        text.push(b'\n');
        replace_file(&path, |file| file.write_all(&text)).map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_comes_back_to_the_last_bit() {
        let state = tempfile::tempdir().unwrap();
        let folder = Folder::new(state.path(), "pump", "sim");
        assert_eq!(folder.read().unwrap(), None);
        let record = Record::new(7.0 / 3.0, 0.1, -1.0 / 3.0e4);
        folder.lock().unwrap().write(&record).unwrap();
        assert_eq!(folder.read().unwrap(), Some(record));
    }

    #[test]
    fn a_second_holder_is_told_who_has_the_pump() {
        let state = tempfile::tempdir().unwrap();
        let folder = Folder::new(state.path(), "pump", "sim");
        let lock = folder.lock().unwrap();
        let error = folder.lock().unwrap_err().to_string();
        assert!(error.contains("pump `pump` is in use by process"), "{error}");
        drop(lock);
        assert!(folder.lock().is_ok());
    }

    #[test]
    fn a_damaged_record_is_an_error_not_a_fresh_start() {
        let state = tempfile::tempdir().unwrap();
        let folder = Folder::new(state.path(), "pump", "sim");
        drop(folder.lock().unwrap());
        for text in ["", "{", "{\"schema\":\"record/2\",\"angle_rad\":0,\"half_width_rad\":0,\"carry_ml\":0}"]
        {
            fs::write(folder.path().join(RECORD), text).unwrap();
            assert!(matches!(folder.read(), Err(RecordError::Damaged { .. })), "{text}");
        }
    }
}
