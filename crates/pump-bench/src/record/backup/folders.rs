//! The files of a folder of records.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::BackupError;
use crate::files::check_plain;
use crate::record::{Folder, Lock};

/// Name of a journal.
pub(super) const JOURNAL: &str = "journal.jsonl";

/// Name of a log.
pub(super) const LOG: &str = "log.jsonl";

/// Lock of a pump, which is no part of its record.
const LOCK: &str = "lock";

/// Beginning of the names of files that are being written.
const STAGED: &str = ".dose-";

/// Returns the failure of an operation on a file.
pub(super) fn failed(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> BackupError {
    let path = path.to_owned();
    move |source| BackupError::File { action, path, source }
}

/// Returns the paths of all files under `folder`, relative to it, in order. A folder that is not there has none.
pub(super) fn files_of(folder: &Path) -> Result<Vec<PathBuf>, BackupError> {
    let mut found = Vec::new();
    collect(folder, Path::new(""), &mut found)?;
    found.sort();
    Ok(found)
}

fn collect(root: &Path, below: &Path, found: &mut Vec<PathBuf>) -> Result<(), BackupError> {
    let folder = root.join(below);
    let entries = match fs::read_dir(&folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(failed("read", &folder)(error)),
    };
    for entry in entries {
        let name = entry.map_err(failed("read", &folder))?.file_name();
        let relative = below.join(&name);
        let path = root.join(&relative);
        check_plain(&path).map_err(failed("read", &path))?;
        match name.to_str() {
            _ if path.is_dir() => collect(root, &relative, found)?,
            Some(name) if name == LOCK || name.starts_with(STAGED) => {}
            _ => found.push(relative),
        }
    }
    Ok(())
}

/// Takes every pump that has a journal or a log among `files` of `root`, so that nothing moves meanwhile.
pub(super) fn lock_all(root: &Path, files: &[PathBuf]) -> Result<Vec<Lock>, BackupError> {
    let folders = records(files).into_iter().filter_map(|folder| {
        let (pump, driver) = (folder.parent()?.to_str()?, folder.file_name()?.to_str()?);
        Some(Folder::new(root, pump, driver))
    });
    folders.map(|folder| folder.lock().map_err(BackupError::from)).collect()
}

/// Returns the folders among `files` that have a journal or a log, each once.
pub(super) fn records(files: &[PathBuf]) -> BTreeSet<&Path> {
    let is_of_record = |file: &&PathBuf| file.file_name().is_some_and(|name| name == JOURNAL || name == LOG);
    files.iter().filter(is_of_record).filter_map(|file| file.parent()).collect()
}
