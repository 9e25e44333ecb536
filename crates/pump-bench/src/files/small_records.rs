//! Small files of a record, read and replaced as a whole, never through links.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use super::plain::FileError;
use super::staged::Staged;
use super::without_links::{check_plain, open_plain};

/// Most bytes of a file of the record that is read whole.
const MOST_BYTES: u64 = 1_000_000;

/// Reads a plain file. A link is refused, and a file that no record can be.
pub(crate) fn read_plain(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_plain(path, File::options().read(true))?.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    let size = bytes.len() as u64;
    if size > MOST_BYTES {
        return Err(FileError::TooLarge { bytes: size, most: MOST_BYTES }.into());
    }
    Ok(bytes)
}

/// Puts a file of a record in place, whole and synced. A link there is refused.
pub(crate) fn replace_plain(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    check_plain(path)?;
    Staged::new(path, write)?.put()
}
