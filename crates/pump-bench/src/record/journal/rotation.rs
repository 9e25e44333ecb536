//! The history of a journal: older entries in files beside it, numbered from 1.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, ErrorKind};
use std::path::{Path, PathBuf};

use crate::files::{Staged, folder_of, open_plain};

/// Keeps the journal at `path` under the next number, as `journal-1.jsonl`. The journal stays where it is, until
/// another takes its place.
///
/// A copy that an earlier process left when it ended between both is replaced.
///
/// # Errors
///
/// The [`io::Error`] of the file system.
pub(super) fn keep(path: &Path) -> io::Result<PathBuf> {
    let last = last_number(path)?;
    let number = match last {
        Some(last) if first_line(&kept(path, last))? == first_line(path)? => {
            fs::remove_file(kept(path, last))?;
            last
        }
        last => last.map_or(1, |last| last + 1),
    };
    let aside = kept(path, number);
    match fs::hard_link(path, &aside) {
        Ok(()) => {}
        Err(error) if error.kind() == ErrorKind::AlreadyExists => return Err(error),
        // Some file systems have no second name for a file.
        Err(_) => {
            let mut journal = open_plain(path, File::options().read(true))?;
            Staged::new(&aside, |to| io::copy(&mut journal, to).map(drop))?.put_new()?;
        }
    }
    Ok(aside)
}

/// Returns the paths of the parts of the journal at `path`, oldest first. The journal itself is the last.
///
/// # Errors
///
/// The [`io::Error`] of the file system.
pub(in crate::record) fn parts(path: &Path) -> io::Result<Vec<PathBuf>> {
    let last = last_number(path)?.unwrap_or(0);
    let older = (1..=last).map(|number| kept(path, number)).filter(|part| part.exists());
    Ok(older.chain([path.to_owned()]).collect())
}

/// Returns the path of a kept part of the journal.
fn kept(path: &Path, number: u32) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}-{number}.jsonl"))
}

/// Returns the largest number of a kept part.
fn last_number(path: &Path) -> io::Result<Option<u32>> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned() + "-";
    let mut last = None;
    for entry in fs::read_dir(folder_of(path))? {
        let name = entry?.file_name();
        let number = name.to_str().and_then(|name| name.strip_prefix(&stem)?.strip_suffix(".jsonl"));
        last = last.max(number.and_then(|number| number.parse().ok()));
    }
    Ok(last)
}

/// Returns the first line of a file: no two parts of a journal have the same.
fn first_line(path: &Path) -> io::Result<Vec<u8>> {
    let mut line = Vec::new();
    BufReader::new(open_plain(path, File::options().read(true))?).read_until(b'\n', &mut line)?;
    Ok(line)
}
