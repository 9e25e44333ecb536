//! The log of a guided calibration. Each reading is on record from the moment that it is typed.

use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{CalibrationError, CalibrationRun, Calibrations};
use crate::files::{check_plain, create_folders, open_plain, sync_folder};
use crate::record::{Folder, decode, encode};

/// File of the log, beside the calibrations that are kept.
const FILE: &str = "unfinished.jsonl";

/// Schema of the log.
const SCHEMA: &str = "runs/1";

/// Runs that a guided calibration is to make.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedRuns {
    /// Speeds of the pump head, in r/min, each as often as it is run, in the order of the runs.
    pub speeds_rpm: Vec<f64>,
    /// Pitches that each run turns.
    pub pitches: u32,
    /// Model volume of a revolution, in mL. Runs of another pump cannot be continued.
    pub revolution_ml: f64,
    /// Name of the fluid. Masses of another fluid are other volumes.
    pub fluid: String,
    /// Mean temperature of the fluid, in °C.
    pub temperature_degc: f64,
}

/// A guided calibration that was begun: its plan, and the runs that were weighed.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct UnfinishedRuns {
    /// Runs that were to be made.
    pub planned: PlannedRuns,
    /// Runs that were weighed, in the order of the plan.
    pub runs: Vec<CalibrationRun>,
}

impl UnfinishedRuns {
    /// Begins a guided calibration. No run has been weighed yet.
    pub fn begun(planned: PlannedRuns) -> Self {
        Self { planned, runs: Vec::new() }
    }
}

/// A line of the log.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum RunLogEntry {
    /// First line: schema and plan.
    Begun { schema: String, planned: PlannedRuns },
    /// A run that was weighed.
    Weighed(CalibrationRun),
    /// Last run, weighed again. Its reading replaces the one before.
    Again(CalibrationRun),
}

/// The log of a guided calibration: one synced line a reading, so that nothing that follows loses it.
///
/// It stands in the folder of the calibrations until a calibration is kept. Whoever writes must hold the
/// pump's lock.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunLog {
    path: PathBuf,
}

impl RunLog {
    /// Returns the log in the folder `calibrations` of a pump's record. Creates nothing.
    pub fn of(folder: &Folder) -> Self {
        Self { path: folder.path().join(super::store::FOLDER).join(FILE) }
    }

    /// Reads the log. Returns `None` if no guided calibration is unfinished. A torn last line was never
    /// answered for, and is left out.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::File`] where the file cannot be read, [`CalibrationError::DamagedLog`] where a
    /// line is not as it was written.
    pub fn read(&self) -> Result<Option<UnfinishedRuns>, CalibrationError> {
        self.check("read")?;
        let text = match fs::read_to_string(&self.path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(self.failed("read")(source)),
        };
        let damaged = |message| CalibrationError::DamagedLog { path: self.path.clone(), message };
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut found: Option<UnfinishedRuns> = None;
        for (number, line) in whole.lines().enumerate() {
            let at = |message: String| damaged(format!("line {}: {message}", number + 1));
            match (decode::<RunLogEntry>(line).map_err(at)?, &mut found) {
                (RunLogEntry::Begun { schema, planned }, None) if schema == SCHEMA => {
                    found = Some(UnfinishedRuns { planned, runs: Vec::new() });
                }
                (RunLogEntry::Begun { schema, .. }, None) => {
                    return Err(at(format!("its schema is `{schema}`; this version reads `{SCHEMA}`")));
                }
                (RunLogEntry::Weighed(run), Some(unfinished)) => unfinished.runs.push(run),
                (RunLogEntry::Again(run), Some(unfinished)) if !unfinished.runs.is_empty() => {
                    unfinished.runs.pop();
                    unfinished.runs.push(run);
                }
                _ => return Err(at("it does not belong there".to_owned())),
            }
        }
        Ok(found)
    }

    /// Reads the readings that a guided calibration can go on with. Returns `None` if there are none, or if one of the
    /// `calibrations` was kept of them: its process then ended before it could remove the log.
    ///
    /// # Errors
    ///
    /// As [`RunLog::read`], and [`CalibrationError`] where the calibrations cannot be read.
    pub fn unfinished(
        &self,
        calibrations: &Calibrations,
    ) -> Result<Option<UnfinishedRuns>, CalibrationError> {
        let Some(found) = self.read()?.filter(|found| !found.runs.is_empty()) else { return Ok(None) };
        let kept = calibrations.list()?;
        Ok(Some(found).filter(|found| kept.last().is_none_or(|last| last.calibration.runs != found.runs)))
    }

    /// Begins a log in place of any other.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::File`] where the log cannot be written.
    pub fn begin(&self, planned: &PlannedRuns) -> Result<(), CalibrationError> {
        let folder = self.path.parent().unwrap_or(Path::new("."));
        self.check("write")?;
        create_folders(folder).map_err(self.failed("create the folder of"))?;
        self.end()?;
        self.append(&RunLogEntry::Begun { schema: SCHEMA.to_owned(), planned: planned.clone() })?;
        sync_folder(folder).map_err(self.failed("write"))
    }

    /// Puts a run on record.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::File`] where the log cannot be written. The runs before stay on record.
    pub fn add(&self, run: &CalibrationRun) -> Result<(), CalibrationError> {
        self.append(&RunLogEntry::Weighed(run.clone()))
    }

    /// Puts a run on record in place of the last one.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::File`] where it cannot be written. The last run then stays on record.
    pub fn replace_last(&self, run: &CalibrationRun) -> Result<(), CalibrationError> {
        self.append(&RunLogEntry::Again(run.clone()))
    }

    /// Removes the log: a calibration was kept, or its runs are given up.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::File`] where the log cannot be removed.
    pub fn end(&self) -> Result<(), CalibrationError> {
        match fs::remove_file(&self.path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            Err(error) => Err(self.failed("remove")(error)),
            Ok(()) => {
                sync_folder(self.path.parent().unwrap_or(Path::new("."))).map_err(self.failed("remove"))
            }
        }
    }

    /// Appends a line, whole and synced, or nothing.
    fn append(&self, entry: &RunLogEntry) -> Result<(), CalibrationError> {
        self.check("write")?;
        let failed = self.failed("write");
        let line = encode(entry).map_err(std::io::Error::from).map_err(&failed)?;
        let mut file =
            open_plain(&self.path, OpenOptions::new().create(true).append(true)).map_err(&failed)?;
        // The torn line of a process that was killed is cut off: this one would run into it.
        let text = fs::read(&self.path).map_err(&failed)?;
        let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1) as u64;
        let written = file
            .set_len(whole)
            .and_then(|()| file.write_all(line.as_bytes()))
            .and_then(|()| file.sync_data());
        written.map_err(|error| {
            // A torn end is left out when the log is read, so a failure here costs nothing.
            let _ = file.set_len(whole);
            failed(error)
        })
    }

    /// Refuses links in place of the log or of its folder.
    fn check(&self, action: &'static str) -> Result<(), CalibrationError> {
        let folder = self.path.parent().unwrap_or(Path::new("."));
        check_plain(folder).and_then(|()| check_plain(&self.path)).map_err(self.failed(action))
    }

    fn failed(&self, action: &'static str) -> impl Fn(std::io::Error) -> CalibrationError {
        let path = self.path.clone();
        move |source| CalibrationError::File { action, path: path.clone(), source }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::Reading;

    fn log(folder: &Path) -> RunLog {
        RunLog::of(&Folder::new(folder, "mine", "sim"))
    }

    fn run(speed_rpm: f64, mass_g: f64) -> CalibrationRun {
        CalibrationRun {
            digit: None,
            speed_rpm,
            start_angle_deg: Some(12.5),
            start_half_width_deg: None,
            turned_deg: 1080.0,
            reading: Reading::MassG(mass_g),
            temperature_degc: None,
            time: Some("2026-11-21T08:00:00Z".to_owned()),
        }
    }

    fn planned() -> PlannedRuns {
        PlannedRuns {
            speeds_rpm: vec![10.0, 10.0, 40.0],
            pitches: 9,
            revolution_ml: 21.318,
            fluid: "water".to_owned(),
            temperature_degc: 25.0,
        }
    }

    #[test]
    fn what_was_typed_is_read_back_and_a_repeated_run_replaces_the_last() {
        let folder = tempfile::tempdir().unwrap();
        let log = log(folder.path());
        assert_eq!(log.read().unwrap(), None);
        log.begin(&planned()).unwrap();
        log.add(&run(10.0, 63.9)).unwrap();
        log.add(&run(10.0, 36.9)).unwrap();
        log.replace_last(&run(10.0, 63.8)).unwrap();
        let runs = vec![run(10.0, 63.9), run(10.0, 63.8)];
        assert_eq!(log.read().unwrap(), Some(UnfinishedRuns { planned: planned(), runs }));
        log.begin(&planned()).unwrap();
        assert_eq!(log.read().unwrap().unwrap().runs, []);
        log.end().unwrap();
        assert_eq!(log.read().unwrap(), None);
    }

    #[test]
    fn a_torn_line_is_left_out_and_written_over_and_a_changed_one_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let log = log(folder.path());
        log.begin(&planned()).unwrap();
        log.add(&run(10.0, 63.9)).unwrap();
        let text = fs::read_to_string(&log.path).unwrap();
        for torn in 1..60 {
            fs::write(&log.path, &text[..text.len() - torn]).unwrap();
            assert_eq!(log.read().unwrap().unwrap().runs, [], "{torn}");
            log.add(&run(10.0, 64.1)).unwrap();
            assert_eq!(log.read().unwrap().unwrap().runs, [run(10.0, 64.1)], "{torn}");
        }
        fs::write(&log.path, text.replace("63.9", "69.3")).unwrap();
        let error = log.read().unwrap_err().to_string();
        assert!(error.contains("line 2") && error.contains("checksum"), "{error}");
    }

    #[test]
    #[cfg(unix)]
    fn a_link_in_place_of_the_log_or_of_its_folder_is_refused() {
        use std::os::unix::fs::symlink;

        let folder = tempfile::tempdir().unwrap();
        let log = log(folder.path());
        log.begin(&planned()).unwrap();
        let other = folder.path().join("other");
        for linked in [log.path.as_path(), log.path.parent().unwrap()] {
            fs::rename(linked, &other).unwrap();
            symlink(&other, linked).unwrap();
            for refused in [log.read().map(drop), log.add(&run(10.0, 63.9)), log.begin(&planned())] {
                let said = crate::report::with_sources(&refused.unwrap_err());
                assert!(said.contains("it is a link"), "{said}");
            }
            fs::remove_file(linked).unwrap();
            fs::rename(&other, linked).unwrap();
        }
        assert!(log.read().unwrap().is_some());
    }
}
