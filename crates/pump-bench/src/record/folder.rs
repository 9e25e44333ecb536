//! The folder in which a pump's journal is kept, and the lock that gives one process at a time the pump.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use pump_model::Pump;
use thiserror::Error;

use super::{Journal, JournalError, Log, PumpState, Story};
use crate::files::{check_plain, create_folders, folder_of, open_plain, place_of};
use crate::pump_file::DriverName;

const JOURNAL: &str = "journal.jsonl";
const LOG: &str = "log.jsonl";
const LOCK: &str = "lock";

/// Folder beside those of the pumps that holds the records of boards which several pumps share. No pump has this name.
pub(crate) const BOARDS: &str = "node.boards";

/// Folder of a journal that cannot be used or locked.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FolderError {
    /// Another process holds the pump.
    #[error("pump `{pump}` is in use by {holder}; wait until it is done (lock file {})", .path.display())]
    Busy {
        /// Id of the pump.
        pump: String,
        /// Holder of the lock, as the lock file names it.
        holder: String,
        /// Path of the lock file.
        path: PathBuf,
    },
    /// A file or folder cannot be used.
    #[error("cannot {action} {}", .path.display())]
    File {
        /// Operation that failed.
        action: &'static str,
        /// Path of the file or folder.
        path: PathBuf,
        /// Cause of the failure.
        source: std::io::Error,
    },
    /// No folder for journals is named or can be found.
    #[cfg_attr(
        not(windows),
        error("no folder for journals: neither an absolute XDG_STATE_HOME nor an absolute HOME is set")
    )]
    #[cfg_attr(
        windows,
        error(
            "no folder for journals: neither an absolute XDG_STATE_HOME nor an absolute LOCALAPPDATA is set"
        )
    )]
    NoFolder,
}

/// Folder `<state dir>/<pump id>/<driver>/` that holds the journal of a pump.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folder {
    path: PathBuf,
    pump: String,
}

/// Variable of the environment that names the folder of a user's own data.
const HOME: &str = if cfg!(windows) { "LOCALAPPDATA" } else { "HOME" };

/// Returns the default folder for journals: `$XDG_STATE_HOME/pump-dose` or `~/.local/state/pump-dose`, on Windows
/// `%LOCALAPPDATA%\pump-dose` (FOLDERID_LocalAppData).
///
/// A relative XDG_STATE_HOME or HOME is ignored, as its specification (XDG Base Directory 0.8) asks for.
///
/// # Errors
///
/// [`FolderError::NoFolder`] if neither of the two variables is set to an absolute path.
pub fn default_state_dir() -> Result<PathBuf, FolderError> {
    let set = |name| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let own = || {
        let home = set(HOME)?;
        Some(if cfg!(windows) { home } else { home.join(".local").join("state") })
    };
    let is_absolute = |path: &PathBuf| path.is_absolute();
    let base = set("XDG_STATE_HOME").filter(is_absolute).or_else(|| own().filter(is_absolute));
    Ok(base.ok_or(FolderError::NoFolder)?.join("pump-dose"))
}

/// Returns true if a path leads to a file of a record in the folder of all records, through links and other spellings
/// too.
///
/// A record is all that lies in `<state dir>/<pump id>/<driver>/`, and what is known of boards that several pumps
/// share. The folder of a driver that is not one of this library is known by its journal or its lock.
pub fn is_of_record(state_dir: &Path, path: &Path) -> bool {
    let (state_dir, path) = (place_of(state_dir), place_of(path));
    let Ok(inside) = path.strip_prefix(&state_dir) else { return false };
    let mut names = inside.components().map(|name| name.as_os_str());
    let (Some(pump), Some(driver)) = (names.next(), names.next()) else { return false };
    if pump == BOARDS || driver.to_str().is_some_and(|driver| driver.parse::<DriverName>().is_ok()) {
        return true;
    }
    let folder = state_dir.join(pump).join(driver);
    [JOURNAL, LOCK].iter().any(|name| folder.join(name).exists())
}

impl Folder {
    /// Names the folder of a pump under a driver. Creates nothing yet.
    pub(crate) fn new(state_dir: &Path, pump: &str, driver: &str) -> Self {
        Self { path: state_dir.join(pump).join(driver), pump: pump.to_owned() }
    }

    /// Names the folder of the same pump under another driver.
    pub(crate) fn of_drive(&self, driver: &str) -> Self {
        Self { path: self.path.with_file_name(driver), pump: self.pump.clone() }
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the journal without holding the pump. `fresh` is the state of a pump without a journal.
    ///
    /// # Errors
    ///
    /// [`JournalError`] if the file cannot be read or a line in it is damaged.
    pub(crate) fn read(&self, pump: &Pump, fresh: PumpState) -> Result<Story, JournalError> {
        Story::read(&self.path.join(JOURNAL), pump, fresh)
    }

    /// Returns the log of the doses.
    pub(crate) fn log(&self) -> Log {
        Log::new(self.path.join(LOG))
    }

    /// Returns the path of the journal.
    pub(crate) fn journal(&self) -> PathBuf {
        self.path.join(JOURNAL)
    }

    /// Returns the other process that holds the pump now, as the lock file names it. Keeps nothing locked.
    pub(crate) fn holder(&self) -> Option<String> {
        let mut file = open_plain(&self.path.join(LOCK), File::options().read(true)).ok()?;
        match file.try_lock_shared() {
            Err(TryLockError::WouldBlock) => {
                Some(named_holder(&mut file)).filter(|holder| *holder != this_process())
            }
            Ok(()) | Err(TryLockError::Error(_)) => None,
        }
    }

    /// Returns the refusal of a pump that `holder` holds.
    pub(crate) fn busy(&self, holder: String) -> FolderError {
        FolderError::Busy { pump: self.pump.clone(), holder, path: self.path.join(LOCK) }
    }

    /// Creates the folder and takes the pump for this process until the lock is dropped.
    ///
    /// # Errors
    ///
    /// [`FolderError::Busy`] if another process holds the pump. [`FolderError::File`] if the folder or the
    /// lock file cannot be written.
    pub fn lock(&self) -> Result<Lock, FolderError> {
        let failed = |action, path: &Path| {
            let path = path.to_owned();
            move |source| FolderError::File { action, path, source }
        };
        // The folder of all records may be a link of the user's. The folders in it are the record's own.
        for folder in [folder_of(&self.path), &self.path] {
            check_plain(folder).map_err(failed("use", folder))?;
        }
        create_folders(&self.path).map_err(failed("create the folder", &self.path))?;
        let path = self.path.join(LOCK);
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = open_plain(&path, &mut options).map_err(failed("write", &path))?;
        // A process that only asks who holds the pump takes the lock for an instant.
        let mut tried = file.try_lock();
        for _ in 0..10 {
            if !matches!(tried, Err(TryLockError::WouldBlock)) {
                break;
            }
            sleep(Duration::from_millis(5));
            tried = file.try_lock();
        }
        match tried {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(self.busy(named_holder(&mut file)));
            }
            Err(TryLockError::Error(source)) => {
                return Err(FolderError::File { action: "lock", path, source });
            }
        }
        let holder = this_process() + "\n";
        file.set_len(0)
            .and_then(|()| file.rewind())
            .and_then(|()| file.write_all(holder.as_bytes()))
            .map_err(failed("write", &path))?;
        Ok(Lock { folder: self.clone(), file, process: std::process::id() })
    }
}

/// Returns the name of this process, as a lock file holds it.
fn this_process() -> String {
    format!("process {}", std::process::id())
}

/// Returns the holder that a locked file names.
fn named_holder(file: &mut File) -> String {
    let mut holder = String::new();
    // On some systems a locked file cannot be read; it is locked all the same.
    let read = file.read_to_string(&mut holder).is_ok() && !holder.trim().is_empty();
    if read { holder.trim().to_owned() } else { "another process".to_owned() }
}

/// Right to move a pump and to write its journal.
#[derive(Debug)]
pub struct Lock {
    folder: Folder,
    file: File,
    /// Process that took the lock.
    process: u32,
}

impl Drop for Lock {
    fn drop(&mut self) {
        // A forked process has this file too, and the lock would go with the last of both. A fork itself
        // leaves the lock alone.
        if self.process == std::process::id() {
            let _ = self.file.unlock();
        }
    }
}

impl Lock {
    /// Opens the journal and reads it.
    ///
    /// # Errors
    ///
    /// [`JournalError`] if the file cannot be read or a line in it is damaged.
    pub(crate) fn journal(&self, pump: &Pump, fresh: PumpState) -> Result<(Journal, Story), JournalError> {
        Journal::open(&self.folder.path.join(JOURNAL), pump, fresh)
    }

    /// Moves a journal back that was set aside at `aside`.
    ///
    /// # Errors
    ///
    /// [`FolderError::File`] if the file cannot be renamed.
    pub(crate) fn put_journal_back(&self, aside: &Path) -> Result<(), FolderError> {
        let path = self.folder.path.join(JOURNAL);
        fs::rename(aside, &path).map_err(|source| FolderError::File { action: "put back", path, source })
    }

    /// Sets an unreadable journal aside, so that a new one can begin. Returns the new path of the old
    /// journal.
    ///
    /// # Errors
    ///
    /// [`FolderError::File`] if the file cannot be renamed.
    pub(crate) fn set_journal_aside(&self) -> Result<PathBuf, FolderError> {
        let path = self.folder.path.join(JOURNAL);
        let mut aside = path.with_extension("damaged");
        let mut n = 1;
        while aside.exists() {
            n += 1;
            aside = path.with_extension(format!("damaged-{n}"));
        }
        match fs::rename(&path, &aside) {
            Ok(()) => Ok(aside),
            Err(source) => Err(FolderError::File { action: "set aside", path, source }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_holder_is_told_who_has_the_pump() {
        let state = tempfile::tempdir().unwrap();
        let folder = Folder::new(state.path(), "pump", "sim");
        let lock = folder.lock().unwrap();
        let error = folder.lock().unwrap_err().to_string();
        assert!(error.contains("pump `pump` is in use by process"), "{error}");
        assert_eq!(folder.holder(), None, "it is not another's");
        drop(lock);
        assert!(folder.lock().is_ok());
    }

    #[test]
    fn a_child_that_inherits_the_lock_file_does_not_keep_the_pump() {
        let state = tempfile::tempdir().unwrap();
        let folder = Folder::new(state.path(), "pump", "sim");
        let lock = folder.lock().unwrap();
        let inherited = lock.file.try_clone().unwrap();
        let mut child = std::process::Command::new("sleep").arg("60").stdin(inherited).spawn().unwrap();
        assert!(folder.lock().is_err());
        drop(lock);
        let locked = folder.lock();
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(locked.is_ok(), "{locked:?}");
    }
}
