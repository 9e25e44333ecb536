//! What a pump remembers: an append-only file of entries, each synced before what it announces happens.
//!
//! Before a motion the journal holds its [`Intent`]; during it, before each stretch of half a second or half a millilitre,
//! how far it may go ([`Entry::Progress`]); after it, how things stand ([`Entry::Rest`]). So whatever ends the process,
//! the next one knows between which bounds the dose was delivered. The order of entries counts, never a clock.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use pump_model::Pump;
use thiserror::Error;

use crate::files::{folder_of, sync_folder};

use super::entry::{Entry, State, Unfinished};
use super::line;

/// How much of the end of a journal is read at first, bytes: some hundred entries.
const WINDOW: u64 = 65_536;

/// A journal that cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum JournalError {
    /// The file cannot be used.
    #[error("cannot {action} {}: {source}; make room there, or choose another folder with --state-dir or DOSE_STATE_DIR", .path.display())]
    File {
        /// What was tried.
        action: &'static str,
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A line in the midst of the file says nothing usable.
    #[error(
        "line {line} of the journal {} is damaged: {message}; neither the rotor's angle nor what is owed is known: see \
         where the rollers stand, move the file away, and say so with `dose home --set <ANGLE>`",
        .path.display()
    )]
    Damaged {
        /// Which file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
}

/// A journal open for writing. Whoever holds it holds the pump's lock.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    /// Open once something was written by this process.
    file: Option<File>,
    /// Length of what is written whole, bytes.
    length: u64,
}

/// What a journal says at its end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Story {
    /// How things stand; none if nothing was ever recorded.
    pub state: Option<State>,
    /// The motion under way when the process that wrote it ended, and how things stood before; none if the rotor stood.
    pub cut_off: Option<(State, Unfinished)>,
    /// A last line that was torn, by a crash while it was written; what it announced did not happen.
    pub torn: bool,
    /// Length of the whole lines, bytes.
    length: u64,
}

impl Story {
    /// Reads the journal at `path`, for a pump that without a journal is in state `fresh`: of a long one the end.
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
                // The number of a line is known once all are read.
                Err(_) if start > 0 => wanted = u64::MAX,
                Err((line, message)) => {
                    return Err(JournalError::Damaged { path: path.to_owned(), line, message });
                }
            }
        }
    }

    /// Reads the bytes of a whole journal; otherwise tells which line, from 1, is damaged and how.
    pub fn from_bytes(bytes: &[u8], pump: &Pump, fresh: State) -> Result<Self, (usize, String)> {
        // From the beginning there is nothing before the bytes.
        Ok(Self::of(bytes, 0, pump, fresh)?.unwrap_or_default())
    }

    /// Folds the entries since the last rest, in the bytes of a journal from `start` on; `None` if that rest lies before
    /// them. Only the last line may be torn.
    fn of(bytes: &[u8], start: u64, pump: &Pump, fresh: State) -> Result<Option<Self>, (usize, String)> {
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let (lines, rest) = bytes.split_at(whole);
        // In the midst of a file the first line may have begun before.
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
    /// The journal at `path`, and what it says. Nothing is created or changed yet.
    pub fn open(path: &Path, pump: &Pump, fresh: State) -> Result<(Self, Story), JournalError> {
        let story = Story::read(path, pump, fresh)?;
        Ok((Self { path: path.to_owned(), file: None, length: story.length }, story))
    }

    /// Appends an entry, in place of a torn last line, and waits until it is on the disk. After an error the journal is as
    /// before.
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
            // Half a line that cannot be taken back is torn: the next reader ignores it.
            let _ = file.set_len(self.length);
            return Err(self.failed(error));
        }
        self.length += line.len() as u64;
        Ok(())
    }

    /// Opens the file and cuts off what is torn.
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
