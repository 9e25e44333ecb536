//! The story that a journal tells: its entries since the last rest, read from its end.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use pump_model::Pump;
use thiserror::Error;

use super::Entry;
use super::tail::{Damage, Tail, format_of};
use crate::files::open_plain;
use crate::record::{LogPlace, PumpState, Unfinished};

/// Format of the journals that this version writes. It reads older ones too.
pub(super) const FORMAT: u32 = 2;

/// Length of the journal's end that is read first, in bytes. It holds some hundred entries.
const WINDOW: u64 = 65_536;

/// Length of the journal's beginning in which its first line ends, in bytes.
const HEAD: u64 = 4096;

/// Journal that cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum JournalError {
    /// The file cannot be read or written.
    #[error("cannot {action} {}", .path.display())]
    File {
        /// Operation that failed.
        action: &'static str,
        /// Path of the journal.
        path: PathBuf,
        /// Cause of the failure.
        source: io::Error,
    },
    /// A line before the end of the file is damaged.
    #[error(
        "{line} of the journal {} is damaged: {message}; neither the rotor's angle nor the carry is known",
        .path.display()
    )]
    Damaged {
        /// Path of the journal.
        path: PathBuf,
        /// Place of the damaged line, as "line 3" or "line 3 from the end".
        line: String,
        /// Damage of the line.
        message: String,
    },
    /// A newer version wrote the journal.
    #[error(
        "the journal {} has format {format}, and this version reads formats 1 to {FORMAT}: use the version \
         that wrote it, or a newer one",
        .path.display()
    )]
    Newer {
        /// Path of the journal.
        path: PathBuf,
        /// Format of the journal.
        format: u32,
    },
}

/// Contents of a journal at its end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Story {
    /// Last state of the pump. `None` if nothing was ever recorded.
    pub state: Option<PumpState>,
    /// True if the record is of another head than the pump's: the state has an unknown angle then.
    pub(crate) other_head: bool,
    /// True if the record is of a motor with other steps than the pump's, or that is turned round, so that the angle is
    /// unknown that was known then.
    pub(crate) other_steps: bool,
    /// Volumes of a revolution, in mL, when the unfinished dose was begun and by the pump file of now, if they differ.
    /// The delivered volume counts by the first.
    pub(crate) other_volumes: Option<(f64, f64)>,
    /// State before the last motion, and that motion, if the process ended during it. `None` if the rotor
    /// stood.
    pub cut_off: Option<(PumpState, Unfinished)>,
    /// True if the last line is torn by a crash while it was written. The motion that it announced did not
    /// happen.
    pub torn: bool,
    /// Last entry, if it is a rest.
    pub(super) rest: Option<Entry>,
    /// Format of the lines. Zero without a journal.
    pub(super) format: u32,
    /// Number of the next line.
    pub(super) next: u64,
    /// Length of the whole lines, in bytes.
    pub(super) length: u64,
}

impl Story {
    /// Returns the story as a motor with steps of `step_rad` takes it.
    #[must_use]
    pub(crate) fn of_steps(self, step_rad: f64, pump: &Pump) -> Self {
        let is_lost =
            |state: PumpState| state.phase().is_known(pump.pitch_rad()) && state.is_of_other_steps(step_rad);
        let other_steps = self.state.is_some_and(is_lost);
        Self { state: self.state.map(|state| state.of_steps(step_rad, pump)), other_steps, ..self }
    }

    /// Returns the place in the log of the last dose on record.
    pub(crate) fn last_logged(&self) -> LogPlace {
        let number = self.state.map_or(0, |state| state.doses);
        let by_number = LogPlace { number, ..LogPlace::default() };
        match &self.rest {
            Some(Entry::Rest { dose: Some(dose), .. }) => dose.place().max(by_number),
            _ => by_number,
        }
    }

    /// Returns true if the device, once it is met again, may tell how many steps of the unfinished `dose` it made: the
    /// process ended during the dose, or the device was out of reach.
    pub(crate) fn board_may_tell(&self, dose: &Unfinished) -> bool {
        match self.cut_off {
            Some((before, _)) => before.count.is_some(),
            None => dose.count_before.is_some(),
        }
    }

    /// Reads the end of the journal at `path`. `fresh` is the state of a pump without a journal.
    ///
    /// # Errors
    ///
    /// [`JournalError::File`] if the file cannot be read. [`JournalError::Damaged`] if the file is empty, or a
    /// line since the last rest is damaged or missing. [`JournalError::Newer`] if a newer version wrote it.
    pub fn read(path: &Path, pump: &Pump, fresh: PumpState) -> Result<Self, JournalError> {
        let failed = |source| JournalError::File { action: "read", path: path.to_owned(), source };
        let mut file = match open_plain(path, File::options().read(true)) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Self::default()),
            Err(source) => return Err(failed(source)),
        };
        let length = file.metadata().map_err(failed)?.len();
        let mut head = Vec::new();
        (&mut file).take(HEAD).read_to_end(&mut head).map_err(failed)?;
        let format = format_of(&head);
        if let Ok(format) = format
            && format > FORMAT
        {
            return Err(JournalError::Newer { path: path.to_owned(), format });
        }
        let mut wanted = WINDOW;
        loop {
            let start = length.saturating_sub(wanted);
            let mut bytes = Vec::new();
            file.seek(SeekFrom::Start(start)).and_then(|_| file.read_to_end(&mut bytes)).map_err(failed)?;
            let tail = Tail { bytes: &bytes, start, format: &format };
            match tail.story(pump, fresh) {
                Ok(Some(story)) => return Ok(story),
                Ok(None) => wanted = wanted.saturating_mul(8),
                Err(damage) => {
                    let Damage { line, message } = damage;
                    return Err(JournalError::Damaged { path: path.to_owned(), line, message });
                }
            }
        }
    }

    /// Reads the bytes of a whole journal.
    ///
    /// # Errors
    ///
    /// The place of the damaged line, and its damage.
    pub fn from_bytes(bytes: &[u8], pump: &Pump, fresh: PumpState) -> Result<Self, (String, String)> {
        let format = format_of(bytes);
        let told = Tail { bytes, start: 0, format: &format }.story(pump, fresh);
        // Nothing stands before the bytes of a whole journal.
        told.map(Option::unwrap_or_default).map_err(|Damage { line, message }| (line, message))
    }
}
