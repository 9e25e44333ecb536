//! The files of a first run: the answers on record, the pump file, and its line in the configuration.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use super::answers::Answers;
use super::error::SetupError;
use crate::config::Config;
use crate::files::{MOST_PUMP_FILE_BYTES, Staged, create_folders, folder_of, read_text};
use crate::pump_file::PumpFile;

/// Folder of the configuration, in which first runs keep their files: `setup/NAME.toml` the answers, `pumps/NAME.toml`
/// the pump file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SetupFolder {
    pub(super) config: PathBuf,
    /// Folder of the records that a configuration without a file will name.
    state_dir: Option<PathBuf>,
}

impl SetupFolder {
    /// Returns the folder of the configuration at `config`, whether that file is there or not.
    pub fn of(config: &Path) -> Self {
        Self { config: config.to_owned(), state_dir: None }
    }

    /// Returns the folder whose configuration names `state_dir`, if it has no file yet. Whoever reads that file then
    /// finds the same records, another user's cron too.
    #[must_use]
    pub fn recording_in(self, state_dir: &Path) -> Self {
        let state_dir = std::path::absolute(state_dir).unwrap_or_else(|_| state_dir.to_owned());
        Self { state_dir: Some(state_dir), ..self }
    }

    /// Returns the path of the pump file.
    pub fn pump_file(&self, name: &str) -> PathBuf {
        folder_of(&self.config).join(Self::pump_entry(name))
    }

    /// Returns true if a command that names no pump means this one.
    pub fn is_default_pump(&self, name: &str) -> bool {
        Config::read(&self.config).is_ok_and(|config| config.named_default_pump() == Some(name))
    }

    /// Returns the path of the pump file as the configuration names it.
    fn pump_entry(name: &str) -> PathBuf {
        Path::new("pumps").join(format!("{name}.toml"))
    }

    /// Returns the path of the answers.
    pub(crate) fn answers(&self, name: &str) -> PathBuf {
        self.records().join(format!("{name}.toml"))
    }

    fn records(&self) -> PathBuf {
        folder_of(&self.config).join("setup")
    }

    /// Returns the answers on record for a name, or `None` without any.
    ///
    /// # Errors
    /// [`SetupError::File`] or [`SetupError::Damaged`] if they cannot be read.
    pub fn read(&self, name: &str) -> Result<Option<Answers>, SetupError> {
        let path = self.answers(name);
        let text = match read_text(&path, MOST_PUMP_FILE_BYTES) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(SetupError::File { action: "read", path, source }),
        };
        let answers = Answers::parse(&text);
        let answers = answers.and_then(|answers| match answers.name == name {
            true => Ok(answers),
            false => Err(format!("they are those of `{}`", answers.name)),
        });
        answers.map(Some).map_err(|message| SetupError::Damaged { path, message })
    }

    /// Puts answers on record, with the present time. They are on the disk when this returns.
    ///
    /// # Errors
    /// [`SetupError::File`] if they cannot be written.
    pub fn keep(&self, answers: &mut Answers) -> Result<(), SetupError> {
        answers.unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |elapsed| elapsed.as_secs());
        write(&self.answers(&answers.name), &answers.to_toml())
    }

    /// Returns all answers on record, the newest first. A record that cannot be understood is left out.
    pub fn all(&self) -> Vec<Answers> {
        let entries = fs::read_dir(self.records()).into_iter().flatten().flatten();
        let names = entries.filter_map(|entry| {
            let path = entry.path();
            let is_record = path.extension().is_some_and(|extension| extension == "toml");
            is_record.then(|| path.file_stem()?.to_str().map(str::to_owned)).flatten()
        });
        let mut all: Vec<Answers> = names.filter_map(|name| self.read(&name).ok().flatten()).collect();
        all.sort_by(|one, other| (other.unix_s, &other.name).cmp(&(one.unix_s, &one.name)));
        all
    }

    /// Writes the pump file `text` and its line in the configuration, and notes that in `answers`.
    ///
    /// # Errors
    /// [`SetupError::Changed`] if somebody has changed the file since it was written. [`SetupError::Taken`] if there is
    /// a file that no first run of this name has written. Otherwise [`SetupError::File`] or [`SetupError::Config`].
    pub fn write_pump(&self, answers: &mut Answers, text: &str) -> Result<PathBuf, SetupError> {
        let path = self.pump_file(&answers.name);
        let found = match read_text(&path, MOST_PUMP_FILE_BYTES) {
            Ok(found) => Some(found),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(source) => return Err(SetupError::File { action: "read", path, source }),
        };
        match (&found, answers.done.written) {
            // The process may have ended after it wrote the file and before it noted that.
            (Some(found), _) if found == text => {}
            // A person changed by hand a part that no question asks for, and the file stays as it is.
            (Some(_), Some(_)) if self.has_pump(answers, text) => {}
            (Some(found), Some(written)) if crc32fast::hash(found.as_bytes()) != written => {
                return Err(SetupError::Changed { path });
            }
            (Some(_), None) => return Err(SetupError::Taken { name: answers.name.clone(), path }),
            _ => write(&path, text)?,
        }
        self.name_pump(&answers.name)?;
        answers.done.written = Some(crc32fast::hash(text.as_bytes()));
        self.keep(answers)?;
        Ok(path)
    }

    /// Returns true if the pump file is the one of these answers: it is `text`, or somebody has changed in it by hand
    /// what no question asks for, since this text was written.
    pub fn has_pump(&self, answers: &Answers, text: &str) -> bool {
        let found = read_text(&self.pump_file(&answers.name), MOST_PUMP_FILE_BYTES);
        let is_same = answers.done.written == Some(crc32fast::hash(text.as_bytes()));
        answers.done.written.is_some()
            && found.is_ok_and(|found| found == text || (is_same && self.is_of_answers(answers)))
    }

    /// Returns true if the pump file says what these answers do. What no first run asks for may differ: the fluid, the
    /// limits, the tube's life and the uncertainty.
    pub fn is_of_answers(&self, answers: &Answers) -> bool {
        let (Ok(found), Ok((own, _))) =
            (PumpFile::read(&self.pump_file(&answers.name)), answers.pump_file(|_| ""))
        else {
            return false;
        };
        (found.pump.default_rate_ml_s, found.rollers, found.head, found.backplate)
            == (own.pump.default_rate_ml_s, own.rollers, own.head, own.backplate)
            && (found.motor, found.drive, found.ambient, found.inlet, found.outlet)
                == (own.motor, own.drive, own.ambient, own.inlet, own.outlet)
    }

    /// Writes the name of a pump into the configuration.
    fn name_pump(&self, name: &str) -> Result<(), SetupError> {
        let path = &self.config;
        let text = match read_text(path, MOST_PUMP_FILE_BYTES) {
            Ok(text) => Some(text),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(source) => return Err(SetupError::File { action: "read", path: path.clone(), source }),
        };
        let first = || self.state_dir.as_deref().map(Config::first_text);
        let before = text.clone().or_else(first);
        let with = Config::with_pump(before.as_deref(), path, name, &Self::pump_entry(name))?;
        if text.as_deref() == Some(&with) { Ok(()) } else { write(path, &with) }
    }
}

/// Writes a file as a whole, and its folder if that is missing.
pub(super) fn write(path: &Path, text: &str) -> Result<(), SetupError> {
    create_folders(folder_of(path))
        .and_then(|()| Staged::new(path, |file| file.write_all(text.as_bytes())))
        .and_then(Staged::put)
        .map_err(|source| SetupError::File { action: "write", path: path.to_owned(), source })
}
