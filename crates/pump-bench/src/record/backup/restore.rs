//! The return of a backup: a whole new folder of records takes the place of the old one in one step.

use std::fs::{self, File};
use std::io::{self, BufReader, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::BackupError;
use super::archive::unpack;
use super::folders::{JOURNAL, LOG, failed, files_of, lock_all, records};
use super::position::{has_line, position};
use crate::files::{create_folders, folder_of, sync_folder};

/// Folder of calibrations in that of a pump.
const CALIBRATIONS: &str = "calibrations";

/// Backup that was restored.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Restored {
    /// Number of files from the backup.
    pub files: u64,
    /// Folder with the records of before. `None` if there were none.
    pub before: Option<PathBuf>,
}

/// Restores the backup at `path` into `state_dir`. Records of pumps that the backup does not have stay. The folder of
/// before is kept beside it.
///
/// The new folder is written and synced whole, and then takes the place of the old one in one step. So a process that
/// is killed leaves the old records or the new ones.
///
/// # Errors
///
/// [`BackupError::Damaged`] if the file is no whole backup. [`BackupError::TurnsBack`],
/// [`BackupError::OtherHistory`] or [`BackupError::Differs`] if a record here is not the beginning of that in the
/// backup. [`BackupError::Folder`] if a pump is in use. [`BackupError::File`] if a file cannot be read or written.
pub fn restore(state_dir: &Path, path: &Path) -> Result<Restored, BackupError> {
    // A link to the folder stays, and the folder behind it is replaced.
    let linked = fs::canonicalize(state_dir);
    let state_dir = linked.as_deref().unwrap_or(state_dir);
    let parent = folder_of(state_dir);
    create_folders(parent).map_err(failed("create the folder", parent))?;
    // A folder that is dropped is removed with all that is in it.
    let staged = tempfile::Builder::new().prefix(".dose-restore-").tempdir_in(parent);
    let staged = staged.map_err(failed("write beside", state_dir))?;
    let root = staged.path().join("records");
    fs::create_dir(&root).map_err(failed("create the folder", &root))?;
    let mut from = BufReader::new(File::open(path).map_err(failed("read", path))?);
    let unpacked = unpack(&mut from, |file, bytes| write_synced(&root.join(file), bytes));
    let files = unpacked.map_err(failed("unpack", path))?;
    let files = files.map_err(|message| BackupError::Damaged { path: path.to_owned(), message })?;

    let here = files_of(state_dir)?;
    let _locks = lock_all(state_dir, &here)?;
    let here = files_of(state_dir)?;
    for folder in records(&here) {
        check(state_dir, &root, folder)?;
    }
    for file in here.iter().filter(|file| !root.join(file).exists()) {
        let old = state_dir.join(file);
        let bytes = fs::read(&old).map_err(failed("read", &old))?;
        write_synced(&root.join(file), &bytes).map_err(failed("write", &root))?;
    }
    sync_folder(&root).map_err(failed("write", &root))?;
    if !state_dir.exists() {
        fs::rename(&root, state_dir)
            .and_then(|()| sync_folder(parent))
            .map_err(failed("put in place", state_dir))?;
        return Ok(Restored { files, before: None });
    }
    exchange(&root, state_dir)
        .and_then(|()| sync_folder(parent))
        .map_err(failed("put in place", state_dir))?;
    let kept = free_name(state_dir);
    if let Err(error) = fs::rename(&root, &kept) {
        // The old records stay where they are.
        let _ = staged.keep();
        return Err(failed("keep", &kept)(error));
    }
    Ok(Restored { files, before: Some(kept) })
}

/// Refuses a backup in `root` that would turn back the record in `folder` of `state_dir`.
fn check(state_dir: &Path, root: &Path, folder: &Path) -> Result<(), BackupError> {
    let [old_log, new_log] = [state_dir, root].map(|root| root.join(folder).join(LOG));
    let [old, new] = [state_dir, root].map(|root| root.join(folder).join(JOURNAL));
    if !new.exists() && !new_log.exists() {
        return Ok(());
    }
    let (here, last) = position(&old, &old_log).map_err(failed("read", &old))?;
    let (there, newest) = position(&new, &new_log).map_err(failed("read", &new))?;
    let record = || folder.display().to_string();
    if here.line > there.line || here.doses > there.doses {
        return Err(BackupError::TurnsBack { record: record(), here, there });
    }
    if !last.is_empty() && !has_line(&new, &last).map_err(failed("read", &new))? {
        return Err(BackupError::OtherHistory { record: record(), here, there });
    }
    let [old, new] = [state_dir, root].map(|root| root.join(folder).join(CALIBRATIONS));
    for file in files_of(&old)? {
        let path = old.join(&file);
        let is_version = file.extension().is_some_and(|extension| extension == "json");
        let differs = |there| BackupError::Differs { path: path.clone(), there };
        let before = fs::read(&path).map_err(failed("read", &path))?;
        match fs::read(new.join(&file)) {
            Ok(after) if after == before => {}
            // The journal of the backup goes on, so its choice of a calibration is the newer one.
            Ok(_) if !is_version && last != newest => {}
            Ok(_) => return Err(differs("other contents")),
            Err(error) if error.kind() == ErrorKind::NotFound => return Err(differs("none")),
            Err(error) => return Err(failed("read", &new)(error)),
        }
    }
    Ok(())
}

/// Writes a file and syncs it, and its folder.
fn write_synced(path: &Path, bytes: &[u8]) -> io::Result<()> {
    create_folders(folder_of(path))?;
    let mut file = File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    sync_folder(folder_of(path))
}

/// Exchanges two folders in one step.
#[cfg(any(target_os = "linux", target_vendor = "apple"))]
fn exchange(one: &Path, other: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};

    Ok(renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE)?)
}

/// Refuses to exchange two folders where the system cannot do so in one step.
#[cfg(not(any(target_os = "linux", target_vendor = "apple")))]
fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::Error::new(
        ErrorKind::Unsupported,
        "this system cannot exchange two folders in one step; move the folder of records away first",
    ))
}

/// Returns a name beside `folder` that nothing has yet.
fn free_name(folder: &Path) -> PathBuf {
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let named = |n: u32| folder.with_file_name(format!("{name}.before-restore-{n}"));
    (1..).map(named).find(|path| !path.exists()).unwrap_or_else(|| named(0))
}
