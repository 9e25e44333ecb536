//! Plain files: what is read and what is written is no device, no pipe, no folder, and of a sane size.

use std::fs::{self, File, FileType};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Most bytes of a pump file.
pub const MOST_PUMP_FILE_BYTES: u64 = 1_000_000;

/// Most bytes of a table of measurements. A trace of ten minutes in milliseconds has this size.
pub const MOST_TABLE_BYTES: u64 = 64_000_000;

/// A path that is not read or written, because of the kind or the size of the file behind it. It stands inside an
/// [`io::Error`].
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FileError {
    /// A file that is read is not plain.
    #[error("it is {found}; only plain files are read")]
    NotReadable {
        /// Kind of the file.
        found: &'static str,
    },
    /// A file that is read is too large.
    #[error("it has {bytes} bytes; allowed: {most} at most")]
    TooLarge {
        /// Size of the file, in bytes.
        bytes: u64,
        /// Largest size that is read, in bytes.
        most: u64,
    },
    /// A file that is written is not plain.
    #[error("it is {found}; allowed: {}", Self::OUTPUTS)]
    NotWritable {
        /// Kind of the file.
        found: &'static str,
    },
    /// A stream of this process leads to a plain file.
    #[error("it leads to a plain file, to which this process writes already; name another file")]
    Occupied,
}

impl FileError {
    /// Files that may be written, in words.
    pub(crate) const OUTPUTS: &'static str =
        "a plain file, /dev/null, or a pipe or terminal of this process, as /dev/stderr";

    /// Returns the refusal inside an error of the system, if it is one.
    pub(crate) fn of(error: &io::Error) -> Option<&Self> {
        error.get_ref()?.downcast_ref()
    }
}

impl From<FileError> for io::Error {
    fn from(error: FileError) -> Self {
        let kind = match error {
            FileError::TooLarge { .. } => io::ErrorKind::FileTooLarge,
            _ => io::ErrorKind::InvalidInput,
        };
        Self::new(kind, error)
    }
}

/// Words the kind of a file that is not plain.
pub(super) fn kind_of(found: FileType) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if found.is_fifo() {
            return "a pipe";
        }
        if found.is_socket() {
            return "a socket";
        }
    }
    if found.is_dir() { "a folder" } else { "a device" }
}

/// Reads a text of at most `most` bytes from a plain file. A pipe is not waited for.
///
/// # Errors
/// Returns an [`io::Error`] with a [`FileError`] inside for a file that is not plain or is too large, and the error of
/// the system for a file that cannot be read or is no UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    // A pipe blocks whoever opens it, so the kind is asked for first.
    let kind = fs::metadata(path)?.file_type();
    if kind.is_dir() {
        // The system has an error of its own for a folder.
        return fs::read_to_string(path);
    }
    plain(kind)?;
    let file = File::open(path)?;
    let found = file.metadata()?;
    plain(found.file_type())?;
    let mut text = String::new();
    if found.len() <= most {
        // A file may grow while it is read.
        file.take(most + 1).read_to_string(&mut text)?;
    }
    let bytes = found.len().max(text.len() as u64);
    if bytes > most { Err(FileError::TooLarge { bytes, most }.into()) } else { Ok(text) }
}

fn plain(found: FileType) -> io::Result<()> {
    if found.is_file() { Ok(()) } else { Err(FileError::NotReadable { found: kind_of(found) }.into()) }
}

/// Returns the place of a path without links and without `..`, as far as the path exists.
pub fn place_of(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    for ancestor in path.ancestors() {
        if let (Ok(place), Ok(rest)) = (fs::canonicalize(ancestor), path.strip_prefix(ancestor)) {
            // An empty rest would append a separator.
            return if rest.as_os_str().is_empty() { place } else { place.join(rest) };
        }
    }
    path
}

/// Returns true if two paths name one file, through links and other spellings too.
pub fn is_one_file(one: &Path, other: &Path) -> bool {
    if place_of(one) == place_of(other) {
        return true;
    }
    #[cfg(unix)]
    if let (Ok(one), Ok(other)) = (fs::metadata(one), fs::metadata(other)) {
        use std::os::unix::fs::MetadataExt;
        return (one.dev(), one.ino()) == (other.dev(), other.ino());
    }
    false
}

/// Returns the names in a folder, and in the folders that it holds, of the file at `path`. A plain file may have
/// several names (hard links).
pub fn names_in(folder: &Path, path: &Path) -> Vec<PathBuf> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;

        if !fs::metadata(path).is_ok_and(|found| found.is_file() && found.nlink() > 1) {
            return Vec::new();
        }
    }
    // A folder that cannot be read gives no name away, and none of its files can be named by this user.
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut names = Vec::new();
    for entry in entries.flatten() {
        let name = entry.path();
        match entry.file_type() {
            Ok(kind) if kind.is_dir() => names.extend(names_in(&name, path)),
            Ok(kind) if kind.is_file() && is_one_file(&name, path) => names.push(name),
            _ => {}
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_has_at_most_the_bytes_that_are_allowed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        fs::write(&path, "12345").unwrap();
        assert_eq!(read_text(&path, 5).unwrap(), "12345");
        let error = read_text(&path, 4).unwrap_err();
        assert_eq!(FileError::of(&error), Some(&FileError::TooLarge { bytes: 5, most: 4 }));
        let error = read_text(folder.path(), 5).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::IsADirectory);
        assert_eq!(read_text(&path.join("none"), 5).ok(), None);
    }

    #[cfg(unix)]
    #[test]
    fn one_file_has_one_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("a"), "").unwrap();
        fs::hard_link(path("a"), path("hard")).unwrap();
        std::os::unix::fs::symlink(folder.path(), path("here")).unwrap();
        assert!(is_one_file(&path("a"), &path("here/./a")) && is_one_file(&path("a"), &path("hard")));
        assert!(is_one_file(&path("here/new/file"), &path("new/file")));
        assert!(!is_one_file(&path("a"), &path("b")));
    }
}
