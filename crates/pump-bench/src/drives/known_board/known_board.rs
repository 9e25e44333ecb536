//! The board of a pump on record, by which another board is told from it.

use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::axis_record::RecordedPump;
use crate::catalogue::BUILT_IN;
use crate::drives::opening::Opening;
use crate::drives::wire::port_name;
#[cfg(all(feature = "grbl", feature = "node"))]
use crate::files::create_folders;
use crate::files::{read_plain, replace_plain};
use crate::notice::Notice;
use crate::pump_file::Axis;

/// Form of the record.
const SCHEMA: &str = "pump-board/1";

/// Name of the record's file, beside that of the board's settings.
pub(in crate::drives) const RECORD: &str = "board.json";

/// Marks of a board by which it is told from others, as far as it has any.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(in crate::drives) struct KnownBoard {
    /// Number that no other board has. `None` if the board tells none.
    pub(in crate::drives) number: Option<u64>,
    /// Name that the board's port keeps.
    pub(in crate::drives) port_name: Option<String>,
    /// Text that somebody has given the board.
    pub(in crate::drives) text: Option<String>,
    /// Axis that turns the pump of the record. `None` in a record of an early version, and after another pump has taken
    /// the place.
    pub(in crate::drives) axis: Option<Axis>,
    /// Device of the port of a board without axes. It tells boards of one kind apart whose ports keep no name.
    pub(in crate::drives) device: Option<String>,
    /// Pins, and stepper drivers at pins, that turn the pump of the record and no other, where the board has no axes.
    pub(in crate::drives) pins: Vec<String>,
}

/// Board and pump that made place for those that are there now, because a person accepted it.
#[derive(Debug, Default)]
pub(in crate::drives) struct MadePlace {
    /// Words for the board that was on record, if it is another one.
    pub(in crate::drives) board: Option<String>,
    /// True if the board is to be put on record, or a pump makes place.
    is_new: bool,
    /// True if this board is on record now. Otherwise it is from the pump's first motion on.
    is_recorded: bool,
    /// Pumps that were in the place by their records.
    pumps: Vec<String>,
    /// Words for that place.
    place: &'static str,
}

impl MadePlace {
    /// Returns the notes of what was accepted.
    pub(in crate::drives) fn notes(&self) -> impl Iterator<Item = Notice> {
        let now = match self.is_recorded {
            true => "the one at the port is on record now",
            false => "the one at the port is on record from the first motion on",
        };
        let board =
            self.board.iter().map(move |board| format!("another board was on record, {board}; {now}"));
        let pumps = self.pumps.iter().map(|pump| {
            let trial = match is_built_in(pump) {
                true => {
                    "; a built-in pump is a trial and makes place, and its rollers' angle is to be found anew"
                }
                false => "",
            };
            let (place, now) =
                (self.place, if self.is_recorded { "now" } else { "from its first motion on" });
            format!("{place} turned pump `{pump}` by the record; it turns this pump on record {now}{trial}")
        });
        board.chain(pumps).map(Notice::from)
    }
}

/// Board as a file holds it. Its number is hexadecimal: JSON holds no integers of 64 bits.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Recorded {
    schema: String,
    number: Option<String>,
    port_name: Option<String>,
    text: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    axis: Option<Axis>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    device: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pins: Vec<String>,
}

/// Reason for which a board is not that of the pump. Each drive words it as its own error.
#[derive(Debug)]
pub(in crate::drives) enum BoardError {
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
    /// The place on the board turns another pump by the record.
    Taken(Box<PlaceTaken>),
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

/// Place on a board that turns another pump by the record.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
#[error(
    "the {place} of the board at {} ({board}) belongs to pump `{other}` by the record; name another one in the file of \
     {1}, or let {1} take the place of `{other}`",
    .port.display(), pump_in_words(.pump.as_deref())
)]
pub struct PlaceTaken {
    /// Axis or pin of the board, or stepper driver at a pin, as the message words it.
    pub place: String,
    /// Path of the port.
    pub port: PathBuf,
    /// Board, as the message words it.
    pub board: String,
    /// Id of the pump. `None` if the drive was opened for no pump of a bench.
    pub pump: Option<String>,
    /// Id of the pump on record.
    pub other: String,
}

/// Names the pump of a record.
pub(in crate::drives) fn pump_in_words(pump: Option<&str>) -> String {
    pump.map_or_else(|| "the pump".to_owned(), |id| format!("pump `{id}`"))
}

impl KnownBoard {
    /// Returns the marks of the board at `port` that are known before it is asked.
    pub(in crate::drives) fn at_port(port: Option<&Path>, opening: &Opening) -> Self {
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

    /// Returns true if this board is the one on record for certain: they have a mark in common.
    pub(in crate::drives) fn is_surely(&self, recorded: &Self) -> bool {
        let has_mark = recorded.number.is_some() || recorded.port_name.is_some() || recorded.text.is_some();
        let is_elsewhere = recorded.port_name.is_none() && self.device != recorded.device;
        has_mark && !is_elsewhere && self.is_same(recorded)
    }

    /// Returns words for the axis or the first pin that turns this pump and that of the record, which is of the same
    /// board. They are empty if there is none.
    fn place_of(&self, recorded: &Self) -> String {
        let axis = self.axis.filter(|axis| recorded.axis == Some(*axis));
        let pin = self.pins.iter().find(|pin| recorded.pins.contains(pin));
        axis.map(|axis| format!("axis {axis}")).or_else(|| pin.cloned()).unwrap_or_default()
    }

    /// Compares this board at `port` with the one on record, as [`Self::compare`] does, and puts it on record unless
    /// `opening` leaves that for later.
    #[cfg(any(feature = "grbl", feature = "node"))]
    pub(in crate::drives) fn recognise(
        &self,
        port: Option<&Path>,
        opening: &Opening,
    ) -> Result<MadePlace, BoardError> {
        let replaced = self.compare(port, opening)?;
        self.settle(&replaced, opening)?;
        Ok(replaced)
    }

    /// Compares this board at `port` with the one on record, and writes nothing. Another board is refused unless it is
    /// accepted, and so is an axis or a pin that turns another pump. Returns what was accepted.
    pub(in crate::drives) fn compare(
        &self,
        port: Option<&Path>,
        opening: &Opening,
    ) -> Result<MadePlace, BoardError> {
        let Some(path) = record_path(opening) else { return Ok(MadePlace::default()) };
        let recorded = match read(&path) {
            Err(_) if opening.accept_settings => None,
            read => read?,
        };
        let another = recorded.as_ref().filter(|recorded| !self.is_same(recorded)).map(Self::to_string);
        if let Some(recorded) = another.clone().filter(|_| !opening.accept_settings) {
            let (port, found) = (port.unwrap_or(Path::new("")).to_owned(), self.to_string());
            return Err(BoardError::Other { port, pump: opening.pump.clone(), found, recorded });
        }
        let others = self.pumps_in_place(opening);
        // A trial with a built-in pump keeps no place from a pump of the user's own.
        let keeps_place = |other: &&RecordedPump| is_built_in_of(opening) || !is_built_in(&other.pump);
        if let (Some(other), false) = (others.iter().find(keeps_place), opening.accept_settings) {
            return Err(BoardError::Taken(Box::new(PlaceTaken {
                place: self.place_of(&other.board),
                port: port.unwrap_or(Path::new("")).to_owned(),
                board: self.to_string(),
                pump: opening.pump.clone(),
                other: other.pump.clone(),
            })));
        }
        let is_new = recorded.as_ref() != Some(self) || !others.is_empty();
        let is_recorded = !opening.records_later;
        let pumps = others.into_iter().map(|other| other.pump).collect();
        let place = if self.axis.is_some() { "the axis" } else { "the socket" };
        Ok(MadePlace { board: another, is_new, is_recorded, pumps, place })
    }

    /// Puts this board on record, which was compared before, unless it is or `opening` leaves that for later. The pumps
    /// in its place make place now, and not before: a board that cannot be used takes no place.
    pub(in crate::drives) fn settle(
        &self,
        replaced: &MadePlace,
        opening: &Opening,
    ) -> Result<(), BoardError> {
        if replaced.is_new && replaced.is_recorded { self.put_on_record(opening) } else { Ok(()) }
    }

    /// Returns the other pumps that the axis or a pin turns by their records.
    pub(in crate::drives) fn pumps_in_place(&self, opening: &Opening) -> Vec<RecordedPump> {
        let mut others = RecordedPump::of_board(self, opening);
        others.retain(|other| !self.place_of(&other.board).is_empty());
        others
    }

    /// Puts this board on record for a pump that has not moved, and has the pumps make place that its axis turns by
    /// their records. Returns their names.
    #[cfg(all(feature = "grbl", feature = "node"))]
    pub(in crate::drives) fn expect(&self, opening: &Opening) -> Result<Vec<String>, BoardError> {
        let Some(path) = record_path(opening) else { return Ok(Vec::new()) };
        let others = self.pumps_in_place(opening);
        others.iter().try_for_each(|other| other.displace(self))?;
        path.parent()
            .map_or(Ok(()), create_folders)
            .map_err(|error| failed("written", &path, error.to_string()))?;
        self.write(&path)?;
        Ok(others.into_iter().map(|other| other.pump).collect())
    }

    /// Puts this board on record in place of any other, and has the pumps make place that it turns by their records.
    /// [`Self::compare`] has compared it before.
    pub(in crate::drives) fn put_on_record(&self, opening: &Opening) -> Result<(), BoardError> {
        let Some(path) = record_path(opening) else { return Ok(()) };
        self.pumps_in_place(opening).iter().try_for_each(|other| other.displace(self))?;
        self.write(&path)
    }

    /// Refuses a port whose name shows that another board is there, before anything is said to it.
    #[cfg(feature = "grbl")]
    pub(in crate::drives) fn look_at_port(port: Option<&Path>, opening: &Opening) -> Result<(), BoardError> {
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

    pub(in crate::drives) fn write(&self, path: &Path) -> Result<(), BoardError> {
        let recorded = Recorded {
            schema: SCHEMA.to_owned(),
            number: self.number.map(|number| format!("{number:016x}")),
            port_name: self.port_name.clone(),
            text: self.text.clone(),
            axis: self.axis,
            device: self.device.clone(),
            pins: self.pins.clone(),
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
            (None, None) => to.write_str("a board without a port name"),
        }?;
        match &self.text {
            Some(text) => write!(to, ", which calls itself {text:?}"),
            None => Ok(()),
        }
    }
}

/// Returns true for the name of a built-in pump, with which a motor is tried before it has a pump file of its own.
pub(in crate::drives) fn is_built_in(pump: &str) -> bool {
    BUILT_IN.iter().any(|(name, _)| *name == pump)
}

/// Returns true if the pump itself is a built-in one.
fn is_built_in_of(opening: &Opening) -> bool {
    opening.pump.as_deref().is_some_and(is_built_in)
}

pub(super) fn record_path(opening: &Opening) -> Option<PathBuf> {
    opening.settings_record.as_ref().map(|settings| settings.with_file_name(RECORD))
}

/// Returns the board on record. There is none before a board was first met.
pub(in crate::drives) fn read(path: &Path) -> Result<Option<KnownBoard>, BoardError> {
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
    let Recorded { port_name, text, axis, device, pins, .. } = recorded;
    Ok(Some(KnownBoard { number, port_name, text, axis, device, pins }))
}

fn failed(action: &'static str, path: &Path, reason: String) -> BoardError {
    BoardError::Record { action, record: path.to_owned(), reason }
}
