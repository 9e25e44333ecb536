//! The board of a pump on record, by which another board is told from it.

use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::opening::Opening;
use super::wire::port_name;
use crate::files::{read_plain, replace_plain};

/// Form of the record.
const SCHEMA: &str = "pump-board/1";

/// Name of the record's file, beside that of the board's settings.
const RECORD: &str = "board.json";

/// Marks of a board by which it is told from others, as far as it has any.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct KnownBoard {
    /// Number that no other board has. `None` if the board tells none.
    pub(super) number: Option<u64>,
    /// Name that the board's port keeps.
    pub(super) port_name: Option<String>,
    /// Text that somebody has given the board.
    pub(super) text: Option<String>,
}

/// Board as a file holds it. Its number is hexadecimal: JSON holds no integers of 64 bits.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Recorded {
    schema: String,
    number: Option<String>,
    port_name: Option<String>,
    text: Option<String>,
}

/// Reason for which a board is not that of the pump. Each drive words it as its own error.
#[derive(Debug)]
pub(super) enum BoardError {
    /// The board on record is another one.
    Other {
        /// Path of the port.
        port: PathBuf,
        /// Id of the pump, as [`Opening::pump`].
        pump: Option<String>,
        /// Words for the board at the port.
        found: String,
        /// Words for the board on record.
        recorded: String,
    },
    /// The record cannot be used.
    Record {
        /// Operation that failed, as the message words it.
        action: &'static str,
        /// Path of the record.
        record: PathBuf,
        /// Cause of the failure.
        reason: String,
    },
}

/// Names the pump of a record.
pub(super) fn pump_in_words(pump: Option<&str>) -> String {
    pump.map_or_else(|| "the pump".to_owned(), |id| format!("pump `{id}`"))
}

impl KnownBoard {
    /// Returns the marks of the board at `port` that are known before it is asked.
    pub(super) fn at_port(port: Option<&Path>, opening: &Opening) -> Self {
        let port_name =
            port.zip(opening.port_names.as_deref()).and_then(|(port, folder)| port_name(port, folder));
        Self { port_name, ..Self::default() }
    }

    /// Returns true if this board is the one on record, as far as can be told. A number outweighs all other marks.
    fn is_same(&self, recorded: &Self) -> bool {
        match (self.number, recorded.number) {
            (Some(found), Some(recorded)) => found == recorded,
            (None, Some(_)) => false,
            (_, None) => self.port_name == recorded.port_name && self.text == recorded.text,
        }
    }

    /// Compares this board at `port` with the one on record, and puts it on record unless `opening` leaves that for
    /// later. Another board is refused unless it is accepted. Returns words for the board that was on record if another
    /// was accepted.
    pub(super) fn recognise(
        &self,
        port: Option<&Path>,
        opening: &Opening,
    ) -> Result<Option<String>, BoardError> {
        let Some(path) = record_path(opening) else { return Ok(None) };
        let recorded = match read(&path) {
            Err(_) if opening.accept_settings => None,
            read => read?,
        };
        let another = recorded.as_ref().filter(|recorded| !self.is_same(recorded)).map(Self::to_string);
        if let Some(recorded) = another.clone().filter(|_| !opening.accept_settings) {
            let (port, found) = (port.unwrap_or(Path::new("")).to_owned(), self.to_string());
            return Err(BoardError::Other { port, pump: opening.pump.clone(), found, recorded });
        }
        if recorded.as_ref() != Some(self) && !opening.records_later {
            self.write(&path)?;
        }
        Ok(another)
    }

    /// Puts this board on record in place of any other. [`Self::recognise`] has compared it before.
    pub(super) fn put_on_record(&self, opening: &Opening) -> Result<(), BoardError> {
        record_path(opening).map_or(Ok(()), |path| self.write(&path))
    }

    /// Refuses a port whose name shows that another board is there, before anything is said to it.
    #[cfg(feature = "grbl")]
    pub(super) fn look_at_port(port: Option<&Path>, opening: &Opening) -> Result<(), BoardError> {
        let (Some(path), Some(port)) = (record_path(opening), port) else { return Ok(()) };
        if opening.accept_settings || !port.exists() {
            return Ok(());
        }
        let (found, recorded) = (Self::at_port(Some(port), opening), read(&path)?);
        match recorded {
            Some(recorded) if found.port_name != recorded.port_name => {
                let recorded = Self { text: None, ..recorded };
                let (port, pump, found) = (port.to_owned(), opening.pump.clone(), found.to_string());
                Err(BoardError::Other { port, pump, found, recorded: recorded.to_string() })
            }
            _ => Ok(()),
        }
    }

    fn write(&self, path: &Path) -> Result<(), BoardError> {
        let recorded = Recorded {
            schema: SCHEMA.to_owned(),
            number: self.number.map(|number| format!("{number:016x}")),
            port_name: self.port_name.clone(),
            text: self.text.clone(),
        };
        let written = replace_plain(path, |to| {
            serde_json::to_writer(&mut *to, &recorded)?;
            to.write_all(b"\n")
        });
        written.map_err(|error| failed("written", path, error.to_string()))
    }
}

/// Names the board: `number e66058388372b0a2 (usb-pump-dose_node_e66058388372b0a2-if00)`.
impl fmt::Display for KnownBoard {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.number, &self.port_name) {
            (Some(number), Some(name)) => write!(to, "number {number:016x} ({name})"),
            (Some(number), None) => write!(to, "number {number:016x}"),
            (None, Some(name)) => to.write_str(name),
            (None, None) => to.write_str("a board whose port has no name"),
        }?;
        match &self.text {
            Some(text) => write!(to, " that calls itself {text:?}"),
            None => Ok(()),
        }
    }
}

fn record_path(opening: &Opening) -> Option<PathBuf> {
    opening.settings_record.as_ref().map(|settings| settings.with_file_name(RECORD))
}

/// Returns the board on record. There is none before a board was first met.
fn read(path: &Path) -> Result<Option<KnownBoard>, BoardError> {
    let unread = |reason| failed("read", path, reason);
    let bytes = match read_plain(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        read => read.map_err(|error| unread(error.to_string()))?,
    };
    let recorded: Recorded = serde_json::from_slice(&bytes).map_err(|error| unread(error.to_string()))?;
    if recorded.schema != SCHEMA {
        return Err(unread(format!("its schema is {:?}; allowed: {SCHEMA:?}", recorded.schema)));
    }
    let number = recorded.number.map(|digits| u64::from_str_radix(&digits, 16)).transpose();
    let number = number.map_err(|error| unread(error.to_string()))?;
    Ok(Some(KnownBoard { number, port_name: recorded.port_name, text: recorded.text }))
}

fn failed(action: &'static str, path: &Path, reason: String) -> BoardError {
    BoardError::Record { action, record: path.to_owned(), reason }
}
