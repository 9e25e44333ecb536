//! The journal of a pump: an append-only file of entries. Each entry is synced before the motion that it
//! announces.
//!
//! Before a motion the journal holds its [`Intent`](super::Intent). During the motion, [`Entry::Progress`]
//! announces each stretch of half a second or half a millilitre before its steps. After the motion,
//! [`Entry::Rest`] holds the state. So however a process ends, the next one knows the bounds of the volume that
//! was delivered. Only the order of the entries counts, never a clock.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use pump_model::Pump;
use thiserror::Error;

use crate::files::{folder_of, sync_folder};

use super::line;
use super::{Entry, State, Unfinished};

/// Length of the journal's end that is read first, in bytes. It holds some hundred entries.
const WINDOW: u64 = 65_536;

/// Journal that cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum JournalError {
    /// The file cannot be read or written.
    #[error(
        "cannot {action} {}: {source}; make room there, or choose another folder with --state-dir or \
         DOSE_STATE_DIR",
        .path.display()
    )]
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
        "line {line} of the journal {} is damaged: {message}; neither the rotor's angle nor the carry is \
         known: see where the rollers stand, move the file away, and say so with `dose home --set <ANGLE>`",
        .path.display()
    )]
    Damaged {
        /// Path of the journal.
        path: PathBuf,
        /// Number of the damaged line, from 1.
        line: usize,
        /// Damage of the line.
        message: String,
    },
}

/// Journal that is open for writing. Its owner must hold the pump's lock.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    /// File, opened once this process writes its first entry.
    file: Option<File>,
    /// Length of the whole entries, in bytes.
    length: u64,
}

/// Contents of a journal at its end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Story {
    /// Last state of the pump. `None` if nothing was ever recorded.
    pub state: Option<State>,
    /// State before the last motion, and that motion, if the process ended during it. `None` if the rotor
    /// stood.
    pub cut_off: Option<(State, Unfinished)>,
    /// True if the last line is torn by a crash while it was written. The motion that it announced did not
    /// happen.
    pub torn: bool,
    /// Length of the whole lines, in bytes.
    length: u64,
}

impl Story {
    /// Reads the end of the journal at `path`. `fresh` is the state of a pump without a journal.
    ///
    /// # Errors
    ///
    /// [`JournalError::File`] if the file cannot be read. [`JournalError::Damaged`] if a line since the last
    /// rest is damaged.
    pub fn read(path: &Path, pump: &Pump, fresh: State) -> Result<Self, JournalError> {
        let failed = |source| JournalError::File { action: "read", path: path.to_owned(), source };
        let mut file = match File::open(path) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Self::default()),
            Err(source) => return Err(failed(source)),
        };
        let length = file.metadata().map_err(failed)?.len();
        let mut wanted = WINDOW;
        loop {
            let start = length.saturating_sub(wanted);
            let mut bytes = Vec::new();
            file.seek(SeekFrom::Start(start)).and_then(|_| file.read_to_end(&mut bytes)).map_err(failed)?;
            match Self::of(&bytes, start, pump, fresh) {
                Ok(Some(story)) => return Ok(story),
                Ok(None) => wanted = wanted.saturating_mul(8),
                // A line's number is known only once all lines are read.
                Err(_) if start > 0 => wanted = u64::MAX,
                Err((line, message)) => {
                    return Err(JournalError::Damaged { path: path.to_owned(), line, message });
                }
            }
        }
    }

    /// Reads the bytes of a whole journal.
    ///
    /// # Errors
    ///
    /// Number of the damaged line, from 1, and its damage.
    pub fn from_bytes(bytes: &[u8], pump: &Pump, fresh: State) -> Result<Self, (usize, String)> {
        // Nothing stands before the bytes of a whole journal.
        Ok(Self::of(bytes, 0, pump, fresh)?.unwrap_or_default())
    }

    /// Folds the entries since the last rest, in the bytes of a journal from `start` on. Returns `None` if
    /// that rest lies before the bytes. Only the last line may be torn.
    fn of(bytes: &[u8], start: u64, pump: &Pump, fresh: State) -> Result<Option<Self>, (usize, String)> {
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let (lines, rest) = bytes.split_at(whole);
        // Bytes from the midst of a file may begin within a line.
        let partial = usize::from(start > 0);
        let lines: Vec<&[u8]> = lines.split_inclusive(|byte| *byte == b'\n').skip(partial).collect();
        let mut since_rest = Vec::new();
        let mut state = None;
        for (n, line) in lines.iter().enumerate().rev() {
            let text = str::from_utf8(line).map_err(|error| (n + 1, error.to_string()))?;
            match line::decode(text.trim_end()).map_err(|message| (n + 1, message))? {
                Entry::Rest { state: at_rest, .. } => {
                    state = Some(at_rest);
                    break;
                }
                entry => since_rest.push((n + 1, entry)),
            }
        }
        if state.is_none() && start > 0 {
            return Ok(None);
        }
        let mut under_way: Option<Unfinished> = None;
        for (n, entry) in since_rest.into_iter().rev() {
            match (entry, &mut under_way) {
                (Entry::Intent(intent), None) => {
                    under_way = Some(Unfinished { intent, made_least: 0, made_most: 0, count_before: None });
                }
                (Entry::Progress { made, may }, Some(dose)) if made <= may => {
                    (dose.made_least, dose.made_most) = (made, may);
                }
                _ => return Err((n, "it does not follow from the lines before it".to_owned())),
            }
        }
        let cut_off = under_way.map(|part| (state.unwrap_or(fresh), part));
        if let Some((before, part)) = cut_off {
            let after = before.after(&part.intent, part.made_least, part.made_most, pump);
            let unfinished = part.intent.purpose.is_delivery().then_some(part);
            state = Some(State { unfinished, ..after });
        }
        let length = start + whole as u64;
        Ok(Some(Self { state, cut_off, torn: !rest.is_empty(), length }))
    }
}

impl Journal {
    /// Opens the journal at `path` and reads its end. Creates and changes nothing yet.
    ///
    /// # Errors
    ///
    /// [`JournalError`] as in [`Story::read`].
    pub fn open(path: &Path, pump: &Pump, fresh: State) -> Result<(Self, Story), JournalError> {
        let story = Story::read(path, pump, fresh)?;
        Ok((Self { path: path.to_owned(), file: None, length: story.length }, story))
    }

    /// Appends an entry, in place of a torn last line, and waits until it is on the disk. After an error the
    /// journal is as before.
    ///
    /// # Errors
    ///
    /// [`JournalError::File`] if the file cannot be written.
    pub fn append(&mut self, entry: &Entry) -> Result<(), JournalError> {
        let line = line::encode(entry).map_err(|error| self.failed(error.into()))?;
        let file = match self.file.take() {
            Some(file) => file,
            None => self.writable().map_err(|error| self.failed(error))?,
        };
        let file = self.file.insert(file);
        let written = file
            .seek(SeekFrom::Start(self.length))
            .and_then(|_| file.write_all(line.as_bytes()))
            .and_then(|()| file.sync_data());
        if let Err(error) = written {
            // Half a line that cannot be cut off is torn: the next reader ignores it.
            let _ = file.set_len(self.length);
            return Err(self.failed(error));
        }
        self.length += line.len() as u64;
        Ok(())
    }

    /// Opens the file and cuts off a torn last line.
    fn writable(&self) -> io::Result<File> {
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(&self.path)?;
        file.set_len(self.length)?;
        file.sync_all()?;
        sync_folder(folder_of(&self.path))?;
        Ok(file)
    }

    fn failed(&self, source: io::Error) -> JournalError {
        JournalError::File { action: "write", path: self.path.clone(), source }
    }
}

#[cfg(test)]
mod tests {
    use pump_ctl::plan::Phase;

    use crate::displacement::Correction;

    use super::*;
    use crate::record::{Intent, PhaseSource, Terms, Why};

    fn story(entries: &[Entry]) -> Result<Story, (usize, String)> {
        let bytes: String = entries.iter().map(|entry| line::encode(entry).unwrap()).collect();
        let fresh = State::fresh(Phase::known(0.0), PhaseSource::Home);
        Ok(Story::of(bytes.as_bytes(), 0, &Pump::three_roller(), fresh)?.unwrap())
    }

    fn rest(unix_s: u64, angle_rad: f64) -> Entry {
        Entry::Rest { unix_s, why: Why::Set, state: State::fresh(Phase::known(angle_rad), PhaseSource::Home) }
    }

    const INTENT: Entry = Entry::Intent(Intent {
        unix_s: 0,
        purpose: crate::record::Purpose::Dose,
        requested_ml: 3.0,
        carry_in_ml: 0.0,
        planned_ml: 3.0,
        carry_out_ml: 0.0,
        start_angle_rad: 1.0,
        half_width_rad: 0.01,
        steps: -2000,
        step_rad: 0.0005,
        motion_s: 1.0,
        retract_ml: None,
        terms: Terms {
            cruise_rad_s: None,
            smooth: false,
            low_flow: false,
            max_outlet_kpa: None,
            min_inlet_kpa: None,
        },
        correction: Correction::NONE,
    });

    #[test]
    fn the_order_of_entries_counts_and_no_clock() {
        let told = story(&[rest(2_000_000_000, 1.0), rest(5, 2.0)]).unwrap();
        assert_eq!(told.state.unwrap().angle_rad, 2.0);
    }

    #[test]
    fn a_dose_under_way_is_known_by_what_was_announced() {
        let unfinished = |entries: &[Entry]| story(entries).unwrap().state.unwrap();
        let begun = unfinished(&[rest(0, 1.0), INTENT]);
        assert_eq!((begun.angle_rad, begun.half_width_rad), (1.0, 0.01));
        let moved = unfinished(&[
            rest(0, 1.0),
            INTENT,
            Entry::Progress { made: 0, may: 400 },
            Entry::Progress { made: 300, may: 500 },
        ]);
        let dose = moved.unfinished.unwrap();
        assert_eq!((dose.made_least, dose.made_most), (300, 500));
        assert!((moved.angle_rad - (1.0 - 0.2)).abs() < 1e-12);
        assert!((moved.half_width_rad - (0.01 + 0.05)).abs() < 1e-12);
    }

    #[test]
    fn entries_that_do_not_follow_from_each_other_are_damage() {
        let progress = Entry::Progress { made: 0, may: 1 };
        for entries in [&[progress.clone()][..], &[INTENT, INTENT], &[rest(0, 0.0), progress]] {
            assert!(story(entries).is_err());
        }
    }
}
