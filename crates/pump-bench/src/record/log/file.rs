//! The file of a log: one line a dose, with its checksum.
//!
//! The journal's rest after a dose holds the dose's entry, so both are on the disk in one write. The log is a copy of
//! these entries that is quick to read. A process that ends between the two leaves the log behind the journal, and the
//! next session copies what is missing. An entry whose number the log has is never copied again. So the log needs no
//! sync of its own, and no entry is lost or doubled. The log is never cut: it outlives the journal's rotation.
//!
//! A dose whose device was out of reach has a second entry once the device has told the steps. Both have the number of
//! the dose and follow each other, and the second is the one that counts.

use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::str;

use thiserror::Error;

use super::{LogEntry, LogPlace};
use crate::files::{check_plain, open_plain};
use crate::record::journal::{decode, encode};

/// Length of the log's end that is read first, in bytes. It holds some hundred entries.
const WINDOW: u64 = 32_768;

/// Log that cannot be used.
#[derive(Debug, Error)]
#[error("cannot {action} the log {}", .path.display())]
#[non_exhaustive]
pub struct LogError {
    /// Operation that failed.
    pub action: &'static str,
    /// Path of the log.
    pub path: PathBuf,
    /// Cause of the failure.
    pub source: io::Error,
}

/// One line of a log.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[allow(clippy::large_enum_variant, reason = "lines are read one at a time, never kept in numbers")]
pub enum LogLine {
    /// A dose.
    Dose(LogEntry),
    /// A line that nobody can read.
    Damaged {
        /// Number of the line in the file, from 1.
        line: u64,
        /// Damage of the line.
        message: String,
    },
}

/// End of a log: the last dose that it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct LogTail {
    /// Place of the last dose, with the number 0 without one.
    pub(crate) place: LogPlace,
    /// Length of the file up to the end of that dose's line, in bytes.
    pub(super) length: u64,
}

/// Log of a pump under a driver. Whoever writes must hold the pump's lock.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Log {
    path: PathBuf,
}

impl Log {
    /// Names the log at `path`. Creates nothing yet.
    pub(crate) fn new(path: PathBuf) -> Self {
        Self { path }
    }

    /// Reads the end of the log.
    ///
    /// # Errors
    ///
    /// [`LogError`] if the file cannot be read.
    pub(crate) fn tail(&self) -> Result<LogTail, LogError> {
        Ok(self.last_of(|_| true)?.map_or(LogTail::default(), |(tail, _)| tail))
    }

    /// Reads the last dose that `wanted` takes, and the end of its line.
    ///
    /// # Errors
    ///
    /// [`LogError`] if the file cannot be read.
    pub(crate) fn last_of(
        &self,
        wanted: impl Fn(&LogEntry) -> bool,
    ) -> Result<Option<(LogTail, LogEntry)>, LogError> {
        let Some(mut file) = self.readable()? else { return Ok(None) };
        let failed = |source| self.failed("read", source);
        let length = file.metadata().map_err(failed)?.len();
        let mut window = WINDOW;
        loop {
            let start = length.saturating_sub(window);
            let mut bytes = Vec::new();
            file.seek(SeekFrom::Start(start)).and_then(|_| file.read_to_end(&mut bytes)).map_err(failed)?;
            if let Some(last) = last_in(&bytes, start, &wanted) {
                return Ok(Some(last));
            }
            if start == 0 {
                return Ok(None);
            }
            window = window.saturating_mul(8);
        }
    }

    /// Appends a dose after `tail`, in place of whatever stands there: half a line, or the zeros of a disk that lost
    /// power. Returns the new end. A dose that the log has is left out.
    ///
    /// # Errors
    ///
    /// [`LogError`] if the file cannot be written.
    pub(crate) fn append(&self, tail: LogTail, entry: &LogEntry) -> Result<LogTail, LogError> {
        if entry.place() <= tail.place {
            return Ok(tail);
        }
        let failed = |source| self.failed("write", source);
        let line = encode(entry).map_err(|error| failed(error.into()))?;
        let mut options = File::options();
        let mut file =
            open_plain(&self.path, options.write(true).create(true).truncate(false)).map_err(failed)?;
        let written = (|| {
            if file.metadata()?.len() > tail.length {
                file.set_len(tail.length)?;
            }
            file.seek(SeekFrom::Start(tail.length))?;
            file.write_all(line.as_bytes())
        })();
        written.map_err(|source| {
            // Half a line that cannot be cut off is in no reader's way.
            let _ = file.set_len(tail.length);
            failed(source)
        })?;
        Ok(LogTail { place: entry.place(), length: tail.length + line.len() as u64 })
    }

    /// Reads the lines of the log, oldest first, one at a time. A dose may have two, which follow each other.
    ///
    /// # Errors
    ///
    /// [`LogError`] if the file cannot be opened. The lines tell other errors.
    pub(crate) fn lines(&self) -> Result<impl Iterator<Item = Result<LogLine, LogError>> + use<>, LogError> {
        let (mut reader, path) = (self.readable()?.map(BufReader::new), self.path.clone());
        let (mut bytes, mut line) = (Vec::new(), 0);
        Ok(std::iter::from_fn(move || {
            let from = reader.as_mut()?;
            bytes.clear();
            line += 1;
            match from.read_until(b'\n', &mut bytes) {
                Ok(0) => None,
                // A line without an end is being written, or torn: the journal has its dose.
                Ok(_) if !bytes.ends_with(b"\n") => None,
                Ok(_) => Some(Ok(match decoded(&bytes) {
                    Ok(entry) => LogLine::Dose(entry),
                    Err(message) => LogLine::Damaged { line, message },
                })),
                Err(source) => {
                    reader = None;
                    Some(Err(LogError { action: "read", path: path.clone(), source }))
                }
            }
        }))
    }

    /// Returns the path of the log.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Opens the file. `None` if there is none.
    fn readable(&self) -> Result<Option<File>, LogError> {
        let opened =
            check_plain(&self.path).and_then(|()| open_plain(&self.path, File::options().read(true)));
        match opened {
            Ok(file) => Ok(Some(file)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(source) => Err(self.failed("read", source)),
        }
    }

    fn failed(&self, action: &'static str, source: io::Error) -> LogError {
        LogError { action, path: self.path.clone(), source }
    }
}

/// Returns the last whole dose that `wanted` takes of the bytes at `start` of a file. `None` if they hold none.
fn last_in(bytes: &[u8], start: u64, wanted: impl Fn(&LogEntry) -> bool) -> Option<(LogTail, LogEntry)> {
    let mut end = bytes.len();
    while end > 0 {
        let before = bytes[..end - 1].iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        if bytes[end - 1] == b'\n'
            && let Ok(entry) = decoded(&bytes[before..end])
            && wanted(&entry)
        {
            return Some((LogTail { place: entry.place(), length: start + end as u64 }, entry));
        }
        end = before;
    }
    None
}

/// Reads the dose of a line with its newline.
fn decoded(line: &[u8]) -> Result<LogEntry, String> {
    decode(str::from_utf8(line).map_err(|error| error.to_string())?.trim_end())
}
