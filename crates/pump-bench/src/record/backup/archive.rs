//! The file of a backup: a line that names each file, its bytes, and a last line that tells that it is whole.

use std::fs;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::BackupError;
use super::folders::{failed, files_of, lock_all};
use crate::record::Stamp;

const SCHEMA: &str = "backup/1";

/// Longest line that names a file, in bytes.
const LONGEST: u64 = 65_536;

/// First line of a backup.
#[derive(Debug, Serialize, Deserialize)]
struct Head {
    schema: String,
    time: Stamp,
    files: u64,
}

/// Line before the bytes of a file.
#[derive(Debug, Serialize, Deserialize)]
struct Named {
    path: String,
    length: u64,
    crc32: String,
}

/// Last line of a backup.
#[derive(Debug, Serialize, Deserialize)]
struct Tail {
    files: u64,
    /// CRC-32 of the first line and of all lines that name files.
    crc32: String,
}

/// Backup that was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct BackedUp {
    /// Number of files.
    pub files: u64,
    /// Bytes of all files.
    pub bytes: u64,
}

/// Writes all records of `state_dir` as one file. No pump moves meanwhile.
///
/// # Errors
///
/// [`BackupError::Folder`] if a pump is in use. [`BackupError::File`] if a file cannot be read or written.
pub fn backup(state_dir: &Path, time: Stamp, to: &mut dyn Write) -> Result<BackedUp, BackupError> {
    let files = files_of(state_dir)?;
    let _locks = lock_all(state_dir, &files)?;
    // A pump may have moved until it was locked.
    let files = files_of(state_dir)?;
    let mut made = BackedUp { files: files.len() as u64, bytes: 0 };
    let mut names = crc32fast::Hasher::new();
    let unwritten = || failed("write the backup of", state_dir);
    let head = Head { schema: SCHEMA.to_owned(), time, files: made.files };
    names.update(&write_line(to, &head).map_err(unwritten())?);
    for file in &files {
        let path = state_dir.join(file);
        let bytes = fs::read(&path).map_err(failed("read", &path))?;
        let named = Named {
            path: portable(file),
            length: bytes.len() as u64,
            crc32: format!("{:08x}", crc32fast::hash(&bytes)),
        };
        names.update(&write_line(to, &named).map_err(unwritten())?);
        to.write_all(&bytes).and_then(|()| to.write_all(b"\n")).map_err(unwritten())?;
        made.bytes += named.length;
    }
    let tail = Tail { files: made.files, crc32: format!("{:08x}", names.finalize()) };
    write_line(to, &tail).map_err(unwritten())?;
    Ok(made)
}

/// Returns true if the file at `path` begins as a backup does.
///
/// # Errors
///
/// The [`io::Error`] of a file that cannot be read.
pub fn is_backup(path: &Path) -> io::Result<bool> {
    let mut from = BufReader::new(fs::File::open(path)?);
    Ok(read_line::<Head>(&mut from)?.is_ok_and(|(head, _)| head.schema == SCHEMA))
}

/// Reads a backup and gives each file to `take`. The error describes the damage.
pub(super) fn unpack(
    from: &mut dyn BufRead,
    mut take: impl FnMut(&Path, &[u8]) -> io::Result<()>,
) -> io::Result<Result<u64, String>> {
    let (head, first) = match read_line::<Head>(from)? {
        Ok(head) => head,
        Err(message) => return Ok(Err(message)),
    };
    if head.schema != SCHEMA {
        return Ok(Err(format!("its schema is `{}`, not `{SCHEMA}`", head.schema)));
    }
    let mut names = crc32fast::Hasher::new();
    names.update(&first);
    for _ in 0..head.files {
        let (named, line) = match read_line::<Named>(from)? {
            Ok(named) => named,
            Err(message) => return Ok(Err(message)),
        };
        names.update(&line);
        let path = PathBuf::from(&named.path);
        if !path.components().all(|part| matches!(part, Component::Normal(_))) || named.path.is_empty() {
            return Ok(Err(format!("`{}` is no path within the folder of records", named.path)));
        }
        let mut bytes = Vec::new();
        Read::take(&mut *from, named.length.saturating_add(1)).read_to_end(&mut bytes)?;
        let is_whole = bytes.len() as u64 == named.length.saturating_add(1) && bytes.pop() == Some(b'\n');
        if !is_whole || format!("{:08x}", crc32fast::hash(&bytes)) != named.crc32 {
            return Ok(Err(format!("{} in it is damaged", named.path)));
        }
        take(&path, &bytes)?;
    }
    Ok(match read_line::<Tail>(from)? {
        Ok((tail, _)) if tail.files == head.files && tail.crc32 == format!("{:08x}", names.finalize()) => {
            Ok(head.files)
        }
        _ => Err("its end is missing or damaged".to_owned()),
    })
}

/// Writes a line of JSON. Returns its bytes.
fn write_line(to: &mut dyn Write, line: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut bytes = serde_json::to_vec(line)?;
    bytes.push(b'\n');
    to.write_all(&bytes)?;
    Ok(bytes)
}

/// Reads a line of JSON, with its bytes. The error describes the damage.
fn read_line<T: for<'de> Deserialize<'de>>(
    from: &mut dyn BufRead,
) -> io::Result<Result<(T, Vec<u8>), String>> {
    let mut bytes = Vec::new();
    from.take(LONGEST).read_until(b'\n', &mut bytes)?;
    Ok(match serde_json::from_slice(&bytes) {
        Ok(line) if bytes.ends_with(b"\n") => Ok((line, bytes)),
        Ok(_) => Err("it ends within a line".to_owned()),
        Err(error) => Err(error.to_string()),
    })
}

/// Returns a path with `/` between its parts on every platform.
fn portable(path: &Path) -> String {
    path.components().map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}
