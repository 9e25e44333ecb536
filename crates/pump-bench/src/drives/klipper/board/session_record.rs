//! The record of a board's session, beside the pump's journal, and the record of the board, which its pumps share.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use crate::drives::Opening;
use crate::drives::klipper::error::KlipperError;
use crate::files::{create_folders, read_plain, replace_plain};

/// Form of the record.
const SCHEMA: &str = "klipper-session/1";

/// Record as a file holds it. Numbers are hexadecimal: JSON holds no integers of 64 bits.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Recorded {
    schema: String,
    session: String,
    checksum: String,
    has_current: bool,
    slip_steps: u32,
}

/// Session of a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drives::klipper) struct SessionRecord {
    /// Session number.
    pub(in crate::drives::klipper) session: u64,
    /// Checksum of the configuration that the board was given.
    pub(in crate::drives::klipper) checksum: u32,
    /// True if the motor has current.
    pub(in crate::drives::klipper) has_current: bool,
    /// Most steps by which the motor may slip if the motion under way ends without a ramp.
    pub(in crate::drives::klipper) slip_steps: u32,
}

impl SessionRecord {
    /// Returns a random session number.
    pub(in crate::drives::klipper) fn draw() -> u64 {
        // The standard library takes the keys of its hash from the system's source of randomness.
        let mut hasher = RandomState::new().build_hasher();
        hasher.write_u128(SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_nanos()));
        hasher.write_u32(std::process::id());
        hasher.finish()
    }

    /// Returns the path of the record that all pumps of the board at `port` share.
    pub(in crate::drives::klipper) fn of_board(opening: &Opening, port: &Path) -> Option<PathBuf> {
        let device = port.canonicalize().unwrap_or_else(|_| port.to_owned());
        let device = device.to_string_lossy();
        let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
        let name = format!("klipper{}.json", device.chars().map(plain).collect::<String>());
        opening.boards.as_ref().map(|folder| folder.join(name))
    }

    /// Returns the record at `path`. There is none before a board was first met.
    pub(in crate::drives::klipper) fn read(path: &Path) -> Result<Option<Self>, KlipperError> {
        let unread = |reason| failed("read", path, reason);
        let bytes = match read_plain(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            read => read.map_err(|error| unread(error.to_string()))?,
        };
        let recorded: Recorded = serde_json::from_slice(&bytes).map_err(|error| unread(error.to_string()))?;
        if recorded.schema != SCHEMA {
            return Err(unread(format!("its schema is {:?}; allowed: {SCHEMA:?}", recorded.schema)));
        }
        let number = |text: &str| u64::from_str_radix(text, 16).map_err(|error| unread(error.to_string()));
        let session = number(&recorded.session)?;
        let checksum = u32::try_from(number(&recorded.checksum)?);
        let checksum = checksum.map_err(|error| unread(error.to_string()))?;
        let Recorded { has_current, slip_steps, .. } = recorded;
        Ok(Some(Self { session, checksum, has_current, slip_steps }))
    }

    /// Writes the record to `path`. The disk has it afterwards.
    pub(in crate::drives::klipper) fn write(self, path: &Path) -> Result<(), KlipperError> {
        let recorded = Recorded {
            schema: SCHEMA.to_owned(),
            session: format!("{:016x}", self.session),
            checksum: format!("{:08x}", self.checksum),
            has_current: self.has_current,
            slip_steps: self.slip_steps,
        };
        let written = path.parent().map_or(Ok(()), create_folders).and_then(|()| {
            replace_plain(path, |to| {
                serde_json::to_writer(&mut *to, &recorded)?;
                to.write_all(b"\n")
            })
        });
        written.map_err(|error| failed("written", path, error.to_string()))
    }
}

fn failed(action: &'static str, path: &Path, reason: String) -> KlipperError {
    KlipperError::SessionRecord { action, record: path.to_owned(), reason }
}
