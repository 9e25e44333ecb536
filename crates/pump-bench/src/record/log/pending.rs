//! The doses that a journal has and the log does not.

use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind};
use std::path::Path;
use std::str;

use super::LogEntry;
use crate::files::open_plain;
use crate::record::journal::{Entry, decode, parts};

/// Tells the doses of the journal at `path` with numbers after `after`, oldest first, one at a time. The older parts of
/// the journal are read as far back as they are needed. A line that nobody can read is passed over.
///
/// # Errors
///
/// The [`io::Error`] of the file system or of `tell`.
pub(crate) fn pending(
    path: &Path,
    after: u64,
    mut tell: impl FnMut(LogEntry) -> io::Result<()>,
) -> io::Result<()> {
    let parts = parts(path)?;
    let is_start = |part: &&std::path::PathBuf| first_doses(part).is_ok_and(|doses| doses <= after);
    let from = parts.iter().rev().position(|part| is_start(&part)).map_or(0, |back| parts.len() - 1 - back);
    let mut last = after;
    for part in parts.iter().skip(from) {
        each(part, |entry| {
            // A journal begins with a copy of the last rest before it.
            if let Entry::Rest { dose: Some(dose), .. } = entry
                && dose.number > last
            {
                last = dose.number;
                tell(dose)?;
            }
            Ok(true)
        })?;
    }
    Ok(())
}

/// Returns the number of doses at the first rest of a part. 0 where a part has none.
fn first_doses(part: &Path) -> io::Result<u64> {
    let mut first = 0;
    each(part, |entry| match entry {
        Entry::Rest { state, dose, .. } => {
            // The dose of the first rest itself is still to be told if the log lacks it.
            first = dose.map_or(state.doses, |dose| dose.number - 1);
            Ok(false)
        }
        _ => Ok(true),
    })?;
    Ok(first)
}

/// Reads the entries of a part until `read` returns false.
fn each(part: &Path, mut read: impl FnMut(Entry) -> io::Result<bool>) -> io::Result<()> {
    let mut reader = match open_plain(part, File::options().read(true)) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(error),
    };
    let mut bytes = Vec::new();
    loop {
        bytes.clear();
        if reader.read_until(b'\n', &mut bytes)? == 0 {
            return Ok(());
        }
        let entry = str::from_utf8(&bytes).ok().and_then(|line| decode(line.trim_end()).ok());
        if let Some(entry) = entry
            && !read(entry)?
        {
            return Ok(());
        }
    }
}
