//! The dictionary of a board.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::RangeInclusive;
use std::sync::Arc;

use super::constant::Constant;
use super::document::Document;
use super::enumeration::Enumeration;
use super::error::DictionaryError;
use crate::drives::klipper::protocol::{Format, Kind, Message, MessageError};

/// Name of the enumeration of the pins.
///
/// Source: Klipper3d/klipper, `docs/Protocol.md`, "Declaring enumerations".
const PINS: &str = "pin";

/// Name of the enumeration of the firmware's own texts, as the reasons of a shutdown.
///
/// Source: Klipper3d/klipper, `src/sched.c`, whose `shutdown` message has the parameter `static_string_id`.
const TEXTS: &str = "static_string_id";

/// Start of the constants that name the pins which the firmware uses itself.
///
/// Source: Klipper3d/klipper, `src/stm32/serial.c` for one: `RESERVE_PINS_serial`.
const RESERVED: &str = "RESERVE_PINS_";

/// Dictionary of a board.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::drives::klipper) struct Dictionary {
    /// Name of the firmware, as `Klipper`. Old firmware has none.
    app: Option<String>,
    version: String,
    commands: BTreeMap<String, Arc<Format>>,
    responses: BTreeMap<String, Arc<Format>>,
    /// Messages and outputs of the board by number.
    by_id: BTreeMap<i32, Arc<Format>>,
    enumerations: BTreeMap<String, Enumeration>,
    constants: BTreeMap<String, Constant>,
}

impl Dictionary {
    /// Reads a dictionary as the board sends it: zlib, then JSON.
    pub(super) fn of_compressed(bytes: &[u8]) -> Result<Self, DictionaryError> {
        let document = Document::of_compressed(bytes)?;
        let mut by_id = BTreeMap::new();
        let commands = by_name("command", &document.commands)?;
        let responses = by_name("message", &document.responses)?;
        for format in responses.values() {
            number(&mut by_id, Arc::clone(format))?;
        }
        for (string, id) in &document.output {
            let format = Format::output(*id, string).ok_or_else(|| unreadable("output", string))?;
            number(&mut by_id, Arc::new(format))?;
        }
        let enumerations = document.enumerations.iter();
        let enumerations = enumerations.map(|(name, entries)| Ok((name.clone(), Enumeration::new(entries)?)));
        let constants = document.config.iter();
        let constants = constants.map(|(name, value)| Ok((name.clone(), Constant::new(name, value)?)));
        Ok(Self {
            app: document.app,
            version: document.version,
            commands,
            responses,
            by_id,
            enumerations: enumerations.collect::<Result<_, _>>()?,
            constants: constants.collect::<Result<_, _>>()?,
        })
    }

    /// Returns the name of the firmware, if it tells it.
    pub(in crate::drives::klipper) fn app(&self) -> Option<&str> {
        self.app.as_deref()
    }

    /// Returns the version of the firmware.
    #[cfg(any(test, all(feature = "grbl", feature = "node")))]
    pub(in crate::drives::klipper) fn version(&self) -> &str {
        &self.version
    }

    /// Returns the command of a format such as `queue_step oid=%c interval=%u count=%hu add=%hi`.
    ///
    /// The dictionary must have a command of this name with these parameters in this order. The size of a number may
    /// differ, as it does between versions of the firmware.
    pub(in crate::drives::klipper) fn command(&self, wanted: &str) -> Result<Arc<Format>, DictionaryError> {
        self.find("command", &self.commands, wanted)
    }

    /// Returns true if the board has a command of this name.
    pub(in crate::drives::klipper) fn has_command(&self, name: &str) -> bool {
        self.commands.contains_key(name)
    }

    /// Returns the message of a format such as `clock clock=%u`, as [`Self::command`] does.
    pub(in crate::drives::klipper) fn response(&self, wanted: &str) -> Result<Arc<Format>, DictionaryError> {
        self.find("message", &self.responses, wanted)
    }

    fn find(
        &self,
        entry: &'static str,
        formats: &BTreeMap<String, Arc<Format>>,
        wanted: &str,
    ) -> Result<Arc<Format>, DictionaryError> {
        let (version, lacking) = (|| self.version.clone(), wanted.to_owned());
        let Some(format) = Format::new(0, wanted) else { return Err(unreadable(entry, wanted)) };
        let Some(found) = formats.get(format.name()) else {
            return Err(DictionaryError::Lacks { version: version(), entry, wanted: lacking });
        };
        let same = |(ours, theirs): (&(String, Kind), &(String, Kind))| {
            ours.0 == theirs.0 && (ours.1 == Kind::Bytes) == (theirs.1 == Kind::Bytes)
        };
        let (ours, theirs) = (format.parameters(), found.parameters());
        if ours.len() == theirs.len() && ours.iter().zip(theirs).all(same) {
            return Ok(Arc::clone(found));
        }
        let found = found.string().to_owned();
        Err(DictionaryError::Differs { version: version(), found, wanted: lacking })
    }

    /// Returns the messages in the content of a block.
    pub(in crate::drives::klipper) fn read(&self, mut content: &[u8]) -> Result<Vec<Message>, MessageError> {
        let mut messages = Vec::new();
        while !content.is_empty() {
            let id = Format::take_id(&mut content)?;
            let format = self.by_id.get(&id).ok_or(MessageError::Unknown { id })?;
            messages.push(format.take(&mut content)?);
        }
        Ok(messages)
    }

    /// Returns a constant that is a whole number in a range.
    pub(in crate::drives::klipper) fn constant(
        &self,
        name: &str,
        range: RangeInclusive<u32>,
    ) -> Result<u32, DictionaryError> {
        let found = self.constants.get(name).ok_or_else(|| DictionaryError::Lacks {
            version: self.version.clone(),
            entry: "constant",
            wanted: name.to_owned(),
        })?;
        found.number(name, range)
    }

    /// Returns a constant in words. `None` if the board lacks it.
    pub(in crate::drives::klipper) fn constant_text(&self, name: &str) -> Option<String> {
        self.constants.get(name).map(Constant::to_string)
    }

    /// Returns the number of a pin that the firmware does not use itself.
    pub(in crate::drives::klipper) fn pin(&self, name: &str) -> Result<u32, DictionaryError> {
        let pins = self.enumerations.get(PINS);
        let Some(number) = pins.and_then(|pins| pins.value_of(name)) else {
            let mcu = self.constant_text("MCU").unwrap_or_else(|| "of an unknown kind".to_owned());
            let pins = pins.map(Enumeration::words).filter(|words| !words.is_empty());
            let pins = pins.unwrap_or_else(|| "without names".to_owned());
            return Err(DictionaryError::Pin { pin: name.to_owned(), mcu, pins });
        };
        match self.use_of(name) {
            Some(used_as) => {
                Err(DictionaryError::Reserved { pin: name.to_owned(), used_as: used_as.to_owned() })
            }
            None => Ok(number),
        }
    }

    /// Returns the use that the firmware makes of a pin. `None` if it makes none.
    ///
    /// The constant is a list such as `[usart1],PA10,PA9`.
    fn use_of(&self, pin: &str) -> Option<&str> {
        self.constants.iter().find_map(|(name, pins)| {
            let used_as = name.strip_prefix(RESERVED)?;
            let Constant::Text(pins) = pins else { return None };
            pins.split(',').any(|reserved| reserved.trim() == pin).then_some(used_as)
        })
    }

    /// Returns the value of a name, for a parameter such as `spi_bus`.
    #[cfg(test)]
    pub(in crate::drives::klipper) fn choice(
        &self,
        choice: &str,
        name: &str,
    ) -> Result<u32, DictionaryError> {
        let names = self.enumerations.get(choice);
        names.and_then(|names| names.value_of(name)).ok_or_else(|| DictionaryError::Choice {
            choice: choice.to_owned(),
            name: name.to_owned(),
            allowed: names.map(Enumeration::words).unwrap_or_else(|| "none".to_owned()),
        })
    }

    /// Returns a text of the firmware, as the reason of a shutdown.
    pub(in crate::drives::klipper) fn firmware_text(&self, id: u32) -> String {
        let text = self.enumerations.get(TEXTS).and_then(|texts| texts.name_of(id));
        text.unwrap_or_else(|| format!("reason {id}, which its dictionary does not word"))
    }
}

/// Returns formats by their names.
fn by_name(
    entry: &'static str,
    strings: &BTreeMap<String, i32>,
) -> Result<BTreeMap<String, Arc<Format>>, DictionaryError> {
    let mut formats = BTreeMap::new();
    for (string, id) in strings {
        let format = Format::new(*id, string).ok_or_else(|| unreadable(entry, string))?;
        match formats.entry(format.name().to_owned()) {
            Entry::Vacant(place) => _ = place.insert(Arc::new(format)),
            Entry::Occupied(place) => {
                return Err(DictionaryError::Twice { entry: "the name", text: place.key().clone() });
            }
        }
    }
    Ok(formats)
}

/// Notes a format under its number.
fn number(by_id: &mut BTreeMap<i32, Arc<Format>>, format: Arc<Format>) -> Result<(), DictionaryError> {
    match by_id.insert(format.id(), format) {
        None => Ok(()),
        Some(before) => Err(DictionaryError::Twice { entry: "the number", text: before.id().to_string() }),
    }
}

/// Returns the error of an entry that cannot be read.
fn unreadable(entry: &'static str, text: &str) -> DictionaryError {
    DictionaryError::Entry { entry, text: text.to_owned() }
}
