//! Folder of calibrations: a file for each version, never overwritten, and a pointer to the version in use.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use pump_model::Pump;
use serde::Serialize;

use super::{Calibration, CalibrationError, Source};
use crate::files::{Staged, check_plain, create_folders};
use crate::record::Folder;

pub(super) const FOLDER: &str = "calibrations";
const ACTIVE: &str = "active";
const NONE: &str = "none";

/// Model volumes of a revolution that differ by less than this part are the same.
const SAME_PUMP: f64 = 1e-9;

/// The calibrations of a pump under a driver, in `<state dir>/<pump id>/<driver>/calibrations/`. The
/// calibration of a simulated pump is thus never used for a real one. Whoever writes must hold the pump's
/// lock.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Calibrations {
    path: PathBuf,
}

/// A calibration with its number.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Stored {
    /// Number of the calibration, from 1.
    pub version: u32,
    /// Calibration of that number.
    #[serde(flatten)]
    pub calibration: Calibration,
}

impl Stored {
    /// Gives a calibration its number.
    pub fn new(version: u32, calibration: Calibration) -> Self {
        Self { version, calibration }
    }

    /// Returns true if `base`, a pump without calibration, is the one that was calibrated.
    pub fn is_of(&self, base: &Pump) -> bool {
        let (then_ml, now_ml) = (self.calibration.revolution_ml, base.revolution_ml());
        (then_ml - now_ml).abs() <= SAME_PUMP * now_ml
    }
}

impl Calibrations {
    /// Returns the calibrations in a pump's folder. Creates nothing.
    pub(crate) fn of(folder: &Folder) -> Self {
        Self { path: folder.path().join(FOLDER) }
    }

    /// Returns the folder of the calibrations, which may not be there.
    pub(crate) fn folder(&self) -> &Path {
        &self.path
    }

    /// Reads every calibration, oldest first.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::File`] if the folder or a file cannot be read, [`CalibrationError::Damaged`] if a
    /// file is no calibration.
    pub fn list(&self) -> Result<Vec<Stored>, CalibrationError> {
        self.versions()?.into_iter().map(|version| self.read(version)).collect()
    }

    /// Reads the calibration that doses use. Returns `None` if they use none.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::File`] if a file cannot be read, [`CalibrationError::Damaged`] if it is no
    /// calibration.
    pub fn active(&self) -> Result<Option<Stored>, CalibrationError> {
        self.active_version()?.map(|version| self.read(version)).transpose()
    }

    /// Reads the number of the calibration that doses use. Returns `None` if they use none.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::File`] if the pointer cannot be read, [`CalibrationError::Damaged`] if it has no
    /// number.
    pub fn active_version(&self) -> Result<Option<u32>, CalibrationError> {
        let path = self.path.join(ACTIVE);
        self.check("read", &path)?;
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(CalibrationError::File { action: "read", path, source }),
        };
        match text.trim() {
            NONE => Ok(None),
            number => number.parse().map(Some).map_err(|_| CalibrationError::Damaged {
                path,
                message: format!("it says `{number}`, and not the number of a calibration or `{NONE}`"),
            }),
        }
    }

    /// Reads the weighing that waits for more: nobody has chosen a calibration since [`Self::wait`], and the newest is
    /// of a weighed dose of this tube. Returns `None` without one.
    ///
    /// # Errors
    ///
    /// As [`Self::active`].
    pub(crate) fn waiting(&self, tube: u32) -> Result<Option<Stored>, CalibrationError> {
        let path = self.path.join(ACTIVE);
        self.check("read", &path)?;
        let has_pointer = path.try_exists();
        if has_pointer.map_err(|source| CalibrationError::File { action: "read", path, source })? {
            return Ok(None);
        }
        let newest = self.versions()?.last().map(|version| self.read(*version)).transpose()?;
        let waits = |stored: &Stored| {
            stored.calibration.source == Source::Last && stored.calibration.tube_number == Some(tube)
        };
        Ok(newest.filter(waits))
    }

    /// Has doses use no calibration, and the newest wait for the next weighing to join it.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::File`] if the pointer cannot be removed.
    pub(crate) fn wait(&self) -> Result<(), CalibrationError> {
        let path = self.path.join(ACTIVE);
        self.check("remove", &path)?;
        match fs::remove_file(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            removed => removed.map_err(|source| CalibrationError::File { action: "remove", path, source }),
        }
    }

    /// Keeps a calibration under the next number, without using it. Returns that number.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::File`] if the folder cannot be created or read, or the file cannot be written.
    pub fn add(&self, calibration: &Calibration) -> Result<u32, CalibrationError> {
        let failed = |action, path: &Path| {
            let path = path.to_owned();
            move |source| CalibrationError::File { action, path, source }
        };
        self.check("write", &self.path)?;
        create_folders(&self.path).map_err(failed("create the folder", &self.path))?;
        let version = self.versions()?.last().map_or(1, |last| last + 1);
        let path = self.path_of(version);
        let write = |to: &mut dyn Write| {
            serde_json::to_writer_pretty(&mut *to, calibration)?;
            writeln!(to)
        };
        Staged::new(&path, write).and_then(Staged::put_new).map_err(failed("write", &path))?;
        Ok(version)
    }

    /// Has doses use a version, or no calibration, from now on.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::NoSuchVersion`] if there is no such calibration. [`CalibrationError::Damaged`] if
    /// its file is no calibration. [`CalibrationError::File`] if a file cannot be read or written.
    pub fn activate(&self, version: Option<u32>) -> Result<(), CalibrationError> {
        if let Some(version) = version {
            let versions = self.versions()?;
            if !versions.contains(&version) {
                let known: Vec<String> = versions.iter().map(u32::to_string).collect();
                let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                return Err(CalibrationError::NoSuchVersion { version, known });
            }
            self.read(version)?;
        } else if !self.path.exists() {
            return Ok(());
        }
        let path = self.path.join(ACTIVE);
        self.check("write", &path)?;
        let text = version.map_or(NONE.to_owned(), |version| version.to_string());
        Staged::new(&path, |to| writeln!(to, "{text}"))
            .and_then(Staged::put)
            .map_err(|source| CalibrationError::File { action: "write", path, source })
    }

    fn path_of(&self, version: u32) -> PathBuf {
        self.path.join(format!("{version}.json"))
    }

    fn read(&self, version: u32) -> Result<Stored, CalibrationError> {
        let path = self.path_of(version);
        self.check("read", &path)?;
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(source) => return Err(CalibrationError::File { action: "read", path, source }),
        };
        match serde_json::from_str::<Calibration>(&text) {
            Ok(calibration) => match calibration.check() {
                Ok(()) => Ok(Stored { version, calibration }),
                Err(message) => Err(CalibrationError::Damaged { path, message }),
            },
            Err(error) => Err(CalibrationError::Damaged { path, message: error.to_string() }),
        }
    }

    /// Refuses links in place of the folder or of a file in it.
    fn check(&self, action: &'static str, path: &Path) -> Result<(), CalibrationError> {
        [self.path.as_path(), path].into_iter().try_for_each(|path| {
            let path = path.to_owned();
            check_plain(&path).map_err(|source| CalibrationError::File { action, path, source })
        })
    }

    /// Returns the numbers of the calibrations, rising.
    fn versions(&self) -> Result<Vec<u32>, CalibrationError> {
        self.check("read", &self.path)?;
        let failed = |source| CalibrationError::File { action: "read", path: self.path.clone(), source };
        let entries = match fs::read_dir(&self.path) {
            Ok(entries) => entries,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            Err(source) => return Err(failed(source)),
        };
        let mut versions = Vec::new();
        for entry in entries {
            let name = entry.map_err(failed)?.file_name();
            let number = name.to_str().and_then(|name| name.strip_suffix(".json"));
            versions.extend(number.and_then(|number| number.parse::<u32>().ok()));
        }
        versions.sort_unstable();
        Ok(versions)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Source;
    use super::*;

    fn store() -> (tempfile::TempDir, Calibrations, Calibration) {
        let state = tempfile::tempdir().unwrap();
        let store = Calibrations::of(&Folder::new(state.path(), "pump", "sim"));
        let calibration =
            Calibration::empty(&crate::catalogue::built_in("three-roller").unwrap(), Source::File).unwrap();
        (state, store, calibration)
    }

    #[test]
    fn versions_are_kept_apart_and_one_at_most_is_used() {
        let (_state, store, mut calibration) = store();
        assert_eq!((store.active().unwrap(), store.list().unwrap().len()), (None, 0));
        store.activate(None).unwrap();
        assert_eq!(store.add(&calibration).unwrap(), 1);
        assert_eq!(store.active().unwrap(), None, "kept, not used");
        calibration.zero_deg = 1.0 / 3.0;
        assert_eq!(store.add(&calibration).unwrap(), 2);
        store.activate(Some(2)).unwrap();
        let active = store.active().unwrap().unwrap();
        assert_eq!((active.version, &active.calibration), (2, &calibration), "to the last bit");
        store.activate(Some(1)).unwrap();
        assert_eq!(store.active().unwrap().unwrap().calibration.zero_deg, 0.0);
        store.activate(None).unwrap();
        assert_eq!((store.active_version().unwrap(), store.list().unwrap().len()), (None, 2));
        let error = store.activate(Some(3)).unwrap_err().to_string();
        assert!(error.contains("no calibration 3") && error.contains("1, 2"), "{error}");
    }

    #[test]
    fn a_damaged_file_is_an_error_and_no_calibration() {
        let (_state, store, calibration) = store();
        store.add(&calibration).unwrap();
        store.activate(Some(1)).unwrap();
        fs::write(store.path_of(1), "{").unwrap();
        let error = store.active().unwrap_err().to_string();
        assert!(error.contains("1.json is damaged"), "{error}");
        store.activate(None).unwrap();
        assert_eq!(store.active().unwrap(), None);
        fs::write(store.path.join(ACTIVE), "first").unwrap();
        assert!(store.active().is_err());
    }
}
