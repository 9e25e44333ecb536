//! The record of a board, which all pumps of the board share: its session, held by one process at a time.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use super::error::NodeError;
use crate::files::{create_folders, open_plain};

/// Number of tries to take a record, 5 ms apart. A process that ends lets go within that time.
const TRIES: u32 = 10;

/// Place of a board's record. A board is known by its number, and one without a number by its port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct BoardRecord {
    board: u64,
    path: PathBuf,
}

impl BoardRecord {
    /// Names the record of a board at `port`. Number 0 is no number.
    pub(super) fn of(folder: &Path, board: u64, port: &Path) -> Self {
        let name = if board == 0 { of_port(port) } else { format!("{board:016x}") };
        Self { board, path: folder.join(name + ".json") }
    }

    /// Returns the path of the file that holds the session.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Takes the record for this process, for the board at `port`.
    pub(super) fn hold(&self, port: &Path) -> Result<BoardHold, NodeError> {
        let path = self.path.with_extension("lock");
        let failed = |error: std::io::Error| NodeError::SessionRecord {
            action: "locked",
            record: path.clone(),
            reason: error.to_string(),
        };
        path.parent().map_or(Ok(()), create_folders).map_err(failed)?;
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = open_plain(&path, &mut options).map_err(failed)?;
        for tried in 0.. {
            match file.try_lock() {
                Ok(()) => break,
                Err(TryLockError::WouldBlock) if tried < TRIES => sleep(Duration::from_millis(5)),
                Err(TryLockError::WouldBlock) => {
                    let device = match self.board {
                        0 => format!("the board at {}", port.display()),
                        board => format!("board {board:016x} at {}", port.display()),
                    };
                    let holder = named_holder(&mut file);
                    return Err(match held_here(&holder).filter(|other| *other != port) {
                        Some(other) => {
                            let (port, other) = (port.to_owned(), other.to_owned());
                            NodeError::OneNumber { board: self.board, port, other }
                        }
                        None => NodeError::Busy { device: device.into(), holder },
                    });
                }
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
        }
        let holder = format!("{}{}\n", here(), port.display());
        let write =
            file.set_len(0).and_then(|()| file.rewind()).and_then(|()| file.write_all(holder.as_bytes()));
        write.map_err(failed)?;
        Ok(BoardHold { record: self.clone(), file, process: std::process::id() })
    }
}

/// Returns the name of a record by the port: the device behind its links, with letters and digits alone.
fn of_port(port: &Path) -> String {
    let device = port.canonicalize().unwrap_or_else(|_| port.to_owned());
    let device = device.to_string_lossy();
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    format!("port{}", device.chars().map(plain).collect::<String>())
}

/// Returns the holder that a locked file names.
fn named_holder(file: &mut File) -> String {
    let mut holder = String::new();
    let read = file.read_to_string(&mut holder).is_ok() && !holder.trim().is_empty();
    if read { holder.trim().to_owned() } else { "another process".to_owned() }
}

/// Returns the words for this process as a holder, before the port at which it has the board.
fn here() -> String {
    format!("process {} at ", std::process::id())
}

/// Returns the port at which this process has the board, if it is the holder.
fn held_here(holder: &str) -> Option<&Path> {
    holder.strip_prefix(&here()).map(Path::new)
}

/// Record of a board that this process holds until it drops this.
#[derive(Debug)]
pub(super) struct BoardHold {
    record: BoardRecord,
    file: File,
    /// Process that took the record.
    process: u32,
}

impl BoardHold {
    /// Returns true if this is the hold of `record`.
    pub(super) fn is_of(&self, record: &BoardRecord) -> bool {
        self.record == *record
    }
}

impl Drop for BoardHold {
    fn drop(&mut self) {
        // A forked process has this file too, and the lock would go with the last of both.
        if self.process == std::process::id() {
            let _ = self.file.unlock();
        }
    }
}
