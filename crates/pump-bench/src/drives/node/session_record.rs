//! The record of a board and its session, beside the pump's journal.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::ErrorKind;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use super::error::NodeError;
use crate::files::{read_plain, replace_plain};
use crate::pump_file::Axis;

/// Form of the record.
const SCHEMA: &str = "node-session/1";

/// Record as a file holds it. Numbers are hexadecimal: JSON holds no integers of 64 bits.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Recorded {
    schema: String,
    board: String,
    session: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    axis: Option<Axis>,
}

/// Board of a pump, and the session that it was given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SessionRecord {
    /// Number of the board.
    pub(super) board: u64,
    /// Session number.
    pub(super) session: u64,
    /// Axis by which the pump's journal counts. The record of a board has none.
    pub(super) axis: Option<Axis>,
}

impl SessionRecord {
    /// Makes a record with a new random session number for `board`.
    pub(super) fn new(board: u64) -> Self {
        // The standard library takes the keys of its hash from the system's source of randomness.
        let mut hasher = RandomState::new().build_hasher();
        hasher.write_u128(SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_nanos()));
        hasher.write_u32(std::process::id());
        Self { board, session: hasher.finish().max(1), axis: None }
    }

    /// Returns the record at `path`. There is none before a board was first met.
    pub(super) fn read(path: &Path) -> Result<Option<Self>, NodeError> {
        let unread = |reason| NodeError::SessionRecord { action: "read", record: path.to_owned(), reason };
        let bytes = match read_plain(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            read => read.map_err(|error| unread(error.to_string()))?,
        };
        let recorded: Recorded = serde_json::from_slice(&bytes).map_err(|error| unread(error.to_string()))?;
        if recorded.schema != SCHEMA {
            return Err(unread(format!("its schema is {:?}; allowed: {SCHEMA:?}", recorded.schema)));
        }
        let number = |text: &str| u64::from_str_radix(text, 16).map_err(|error| unread(error.to_string()));
        let (board, session) = (number(&recorded.board)?, number(&recorded.session)?);
        Ok(Some(Self { board, session, axis: recorded.axis }))
    }

    /// Writes the record to `path`. The disk has it afterwards.
    pub(super) fn write(self, path: &Path) -> Result<(), NodeError> {
        let recorded = Recorded {
            schema: SCHEMA.to_owned(),
            board: format!("{:016x}", self.board),
            session: format!("{:016x}", self.session),
            axis: self.axis,
        };
        replace_plain(path, |to| {
            serde_json::to_writer(&mut *to, &recorded)?;
            to.write_all(b"\n")
        })
        .map_err(|error| NodeError::SessionRecord {
            action: "written",
            record: path.to_owned(),
            reason: error.to_string(),
        })
    }
}
