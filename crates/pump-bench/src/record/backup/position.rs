//! The position of a record: how far its journal goes.

use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind};
use std::path::Path;
use std::str;

use serde_json::Value;

use crate::files::open_plain;
use crate::record::journal::{decode_numbered, parts};
use crate::record::log::Log;

/// Position of a record: the last entry of its journal, and the last dose of its journal or its log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Position {
    /// Number of the journal's last line. `None` without a journal, or in a journal of version 0.1.0.
    pub line: Option<u64>,
    /// Number of the last dose, by the journal or the log.
    pub doses: u64,
}

impl fmt::Display for Position {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(to, "line {line} of the journal, dose {}", self.doses),
            None if self.doses > 0 => write!(to, "dose {} of the log, without a journal", self.doses),
            None => write!(to, "no numbered line of a journal"),
        }
    }
}

/// Reads the position of the record with this journal and this log, and the journal's last whole line. The line is
/// empty without a journal.
pub(super) fn position(journal: &Path, log: &Path) -> io::Result<(Position, Vec<u8>)> {
    let (mut found, mut last) = (Position::default(), Vec::new());
    each_line(journal, |line| {
        last.clear();
        last.extend_from_slice(line);
        if let Some((line, entry)) = decoded(line) {
            found.line = line;
            found.doses = entry["rest"]["state"]["doses"].as_u64().unwrap_or(found.doses);
        }
        true
    })?;
    // The log of a journal that was lost goes further than the journal that began after it.
    let logged = Log::new(log.to_owned()).tail().map_err(|error| error.source)?;
    found.doses = found.doses.max(logged.place.number);
    Ok((found, last))
}

/// Returns true if the journal at `path`, or an older part of it, has this line.
pub(super) fn has_line(path: &Path, wanted: &[u8]) -> io::Result<bool> {
    let mut found = false;
    for part in parts(path)? {
        each_line(&part, |line| {
            found = line == wanted;
            !found
        })?;
        if found {
            break;
        }
    }
    Ok(found)
}

fn decoded(line: &[u8]) -> Option<(Option<u64>, Value)> {
    decode_numbered(str::from_utf8(line).ok()?.trim_end()).ok()
}

/// Reads the whole lines of a file until `read` returns false. A file that is not there has none.
fn each_line(path: &Path, mut read: impl FnMut(&[u8]) -> bool) -> io::Result<()> {
    let mut reader = match open_plain(path, File::options().read(true)) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(error),
    };
    let mut line = Vec::new();
    loop {
        line.clear();
        // A torn last line is an entry that was never on the disk.
        if reader.read_until(b'\n', &mut line)? == 0 || !line.ends_with(b"\n") || !read(&line) {
            return Ok(());
        }
    }
}
