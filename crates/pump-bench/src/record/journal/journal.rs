//! The journal of a pump: an append-only file of entries. Each entry is synced before the motion that it
//! announces.
//!
//! Before a motion the journal holds its [`Intent`](crate::record::Intent). During the motion, [`Entry::Progress`]
//! announces each stretch before its steps. After the motion, [`Entry::Rest`] holds the state. So however a
//! process ends, the next one knows the bounds of the volume that was delivered. Only the order of the entries
//! counts, never a clock.
//!
//! A long motion keeps the last of its announcements, as [`compaction`](super::compaction) says.
//!
//! The first line tells the format. Each line has the number after that of the line before, so that a line that
//! is missing shows. A journal that has grown long is kept as `journal-1.jsonl`, `journal-2.jsonl` and so on.
//! The new one begins with the last rest of the one before.

use std::fmt::Debug;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use pump_model::Pump;

use super::compaction::Compaction;
use super::story::{FORMAT, JournalError, Story};
use super::{Entry, line, rotation};
use crate::files::{Staged, open_plain};
use crate::record::PumpState;

/// Length from which on a journal is kept and a new one begun, in bytes. It holds some 1500 doses.
const LONG: u64 = 8 << 20;

/// Storage behind a journal.
pub trait Storage: Debug + Send {
    /// Waits until the contents of `file` survive a loss of power.
    ///
    /// # Errors
    ///
    /// [`io::Error`] of the file system.
    fn sync(&mut self, file: &File) -> io::Result<()>;
}

/// Disk of this computer.
#[derive(Debug, Clone, Copy)]
struct Disk;

impl Storage for Disk {
    fn sync(&mut self, file: &File) -> io::Result<()> {
        file.sync_data()
    }
}

/// Journal that is open for writing. Its owner must hold the pump's lock.
#[derive(Debug)]
pub(crate) struct Journal {
    path: PathBuf,
    /// File, opened once this process writes its first entry.
    file: Option<File>,
    /// Format of the lines. Zero before the first entry.
    format: u32,
    /// Number of the next line.
    next: u64,
    /// Length of the whole lines, in bytes.
    length: u64,
    /// Length from which on the journal is kept and a new one begun, in bytes.
    long: u64,
    /// Last entry, if it is a rest.
    rest: Option<Entry>,
    /// Last announcement of the motion under way.
    progress: Option<Entry>,
    compaction: Compaction,
    storage: Box<dyn Storage>,
}

impl Journal {
    /// Opens the journal at `path` and reads its end. Creates and changes nothing yet.
    ///
    /// # Errors
    ///
    /// [`JournalError`] as in [`Story::read`].
    pub(crate) fn open(path: &Path, pump: &Pump, fresh: PumpState) -> Result<(Self, Story), JournalError> {
        let story = Story::read(path, pump, fresh)?;
        let journal = Self {
            path: path.to_owned(),
            file: None,
            format: story.format,
            next: story.next,
            length: story.length,
            long: LONG,
            rest: story.rest.clone(),
            progress: None,
            compaction: Compaction::Off,
            storage: Box::new(Disk),
        };
        Ok((journal, story))
    }

    /// Appends an entry, in place of a torn last line, and waits until it is on the disk. After an error the
    /// journal is as before.
    ///
    /// # Errors
    ///
    /// [`JournalError::File`] if the file cannot be written.
    pub(crate) fn append(&mut self, entry: &Entry) -> Result<(), JournalError> {
        let failed = |action| {
            let path = self.path.clone();
            move |source| JournalError::File { action, path, source }
        };
        let (keeps, writes) = (failed("begin a new journal at"), failed("write"));
        let is_long = self.length > self.long || self.format == 1;
        match (entry, &self.rest) {
            _ if self.format == 0 => return self.begin(&[entry]).map_err(writes),
            // The state in which a motion begins is all that the journal before it tells.
            (Entry::Intent(_), Some(rest)) if is_long => {
                let rest = rest.clone();
                self.begin(&[&rest]).map_err(keeps)?;
            }
            _ => {}
        }
        self.write(entry).map_err(writes)?;
        self.rest = rest_of(entry);
        self.progress = matches!(entry, Entry::Progress { .. }).then(|| entry.clone());
        Ok(())
    }

    /// Keeps the last announcement of a long motion alone, once there are many. The journal tells the same.
    ///
    /// # Errors
    ///
    /// [`JournalError::File`] if the file cannot be written.
    pub(super) fn compact(&mut self) -> Result<(), JournalError> {
        let (Some(file), Some(last)) = (&mut self.file, &self.progress) else { return Ok(()) };
        let compacted = self.compaction.compact(file, self.storage.as_mut(), last, self.length);
        if compacted.is_err() {
            // The next announcement meets the same disk, and says so.
            self.compaction = Compaction::Off;
        }
        let failed = |source| JournalError::File { action: "write", path: self.path.clone(), source };
        if let Some((next, length)) = compacted.map_err(failed)? {
            (self.next, self.length) = (next, length);
        }
        Ok(())
    }

    /// Begins a journal with these entries. The one before, if there is one, is kept beside it.
    fn begin(&mut self, entries: &[&Entry]) -> io::Result<()> {
        let begins = Entry::Begins { format: FORMAT };
        let mut text = String::new();
        let mut next = self.next;
        for entry in [&begins].into_iter().chain(entries.iter().copied()) {
            text += &line::encode_numbered(next, entry)?;
            next += 1;
        }
        // At every instant a whole journal is at its path.
        let staged = Staged::new(&self.path, |to| to.write_all(text.as_bytes()))?;
        if self.format == 0 {
            staged.put_new()?;
        } else {
            rotation::keep(&self.path)?;
            staged.put()?;
        }
        self.file = None;
        self.compaction = Compaction::Off;
        (self.format, self.next, self.length) = (FORMAT, next, text.len() as u64);
        self.rest = entries.last().and_then(|entry| rest_of(entry));
        Ok(())
    }

    /// Appends a line, or leaves the file as it is.
    fn write(&mut self, entry: &Entry) -> io::Result<()> {
        let line = match self.format {
            1 => line::encode(entry)?,
            _ => line::encode_numbered(self.next, entry)?,
        };
        let line = self.compaction.laid_out(entry, line, self.length);
        let file = match self.file.take() {
            Some(file) => file,
            None => self.writable()?,
        };
        let file = self.file.insert(file);
        let written = file
            .seek(SeekFrom::Start(self.length))
            .and_then(|_| file.write_all(line.as_bytes()))
            .and_then(|()| self.storage.sync(file));
        if let Err(error) = written {
            // Half a line that cannot be cut off is torn: the next reader ignores it.
            let _ = file.set_len(self.length);
            return Err(error);
        }
        self.compaction = match self.format {
            1 => Compaction::Off,
            _ => self.compaction.after(entry, self.next, &line, self.length),
        };
        self.length += line.len() as u64;
        self.next += 1;
        Ok(())
    }

    /// Returns the path of the journal.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Has the journal kept and a new one begun from this length on, in bytes.
    #[cfg(test)]
    pub(in crate::record) fn keep_at(&mut self, long: u64) {
        self.long = long;
    }

    /// Has the journal's entries synced by `storage`, in place of the disk itself.
    pub(crate) fn store_by(&mut self, storage: Box<dyn Storage>) {
        self.storage = storage;
    }

    /// Opens the file and cuts off a torn last line.
    fn writable(&self) -> io::Result<File> {
        let file = open_plain(&self.path, File::options().write(true))?;
        if file.metadata()?.len() > self.length {
            file.set_len(self.length)?;
            file.sync_all()?;
        }
        Ok(file)
    }
}

/// Returns the entry if the rotor stands by it.
fn rest_of(entry: &Entry) -> Option<Entry> {
    matches!(entry, Entry::Rest { .. }).then(|| entry.clone())
}

#[cfg(test)]
mod tests;
