//! The record of a board's session, beside the pump's journal.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::ErrorKind;
use std::num::TryFromIntError;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use crate::drives::klipper::error::KlipperError;
use crate::files::{create_folders, read_plain, replace_plain};

/// Form of the record.
const SCHEMA: &str = "klipper-session/2";

/// Record as a file holds it. Numbers are hexadecimal: JSON holds no integers of 64 bits.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Recorded {
    schema: String,
    session: String,
    checksum: String,
    has_current: bool,
    slip_steps: u32,
    cuts: u32,
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
    /// Shutdowns of the session that this motor knows of. Each has taken the current of every motor.
    pub(in crate::drives::klipper) cuts: u32,
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

    /// Returns the record at `path`. There is none before a board was first met.
    pub(in crate::drives::klipper) fn read(path: &Path) -> Result<Option<Self>, KlipperError> {
        let Some(recorded) = read_json::<Recorded>(path)? else { return Ok(None) };
        check_schema(path, &recorded.schema, SCHEMA)?;
        let session = hexadecimal(path, &recorded.session)?;
        let unread = |error: TryFromIntError| failed("read", path, error.to_string());
        let checksum = u32::try_from(hexadecimal(path, &recorded.checksum)?);
        let checksum = checksum.map_err(unread)?;
        let Recorded { has_current, slip_steps, cuts, .. } = recorded;
        Ok(Some(Self { session, checksum, has_current, slip_steps, cuts }))
    }

    /// Writes the record to `path`. The disk has it afterwards.
    pub(in crate::drives::klipper) fn write(self, path: &Path) -> Result<(), KlipperError> {
        let recorded = Recorded {
            schema: SCHEMA.to_owned(),
            session: format!("{:016x}", self.session),
            checksum: format!("{:08x}", self.checksum),
            has_current: self.has_current,
            slip_steps: self.slip_steps,
            cuts: self.cuts,
        };
        write_json(path, &recorded)
    }
}

/// Writes a record. The disk has it afterwards.
pub(super) fn write_json(path: &Path, recorded: &impl Serialize) -> Result<(), KlipperError> {
    let written = path.parent().map_or(Ok(()), create_folders).and_then(|()| {
        replace_plain(path, |to| {
            serde_json::to_writer(&mut *to, recorded)?;
            to.write_all(b"\n")
        })
    });
    written.map_err(|error| failed("written", path, error.to_string()))
}

/// Reads a record. There is none before a board was first met.
pub(super) fn read_json<T: for<'a> Deserialize<'a>>(path: &Path) -> Result<Option<T>, KlipperError> {
    let unread = |reason| failed("read", path, reason);
    let bytes = match read_plain(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        read => read.map_err(|error| unread(error.to_string()))?,
    };
    serde_json::from_slice(&bytes).map(Some).map_err(|error| unread(error.to_string()))
}

/// Reads a number that is hexadecimal in a record: JSON holds no integers of 64 bits.
pub(super) fn hexadecimal(path: &Path, text: &str) -> Result<u64, KlipperError> {
    u64::from_str_radix(text, 16).map_err(|error| failed("read", path, error.to_string()))
}

/// Refuses a record of another form.
pub(super) fn check_schema(path: &Path, schema: &str, allowed: &str) -> Result<(), KlipperError> {
    if schema == allowed {
        return Ok(());
    }
    Err(failed("read", path, format!("its schema is {schema:?}; allowed: {allowed:?}")))
}

fn failed(action: &'static str, path: &Path, reason: String) -> KlipperError {
    KlipperError::SessionRecord { action, record: path.to_owned(), reason }
}
