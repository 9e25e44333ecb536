//! The action of an entry.

use std::collections::BTreeMap;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use toml::Value;

use super::duration::Duration;
use super::error::ScheduleError;
use super::keys::{Keys, shown};

/// Most doses of a batch.
const MOST_DOSES: i64 = 100_000;

/// Options of commands that are no options of an entry, each with its way out, in words.
pub(crate) const NO_OPTIONS: [(&str, &str); 5] = [
    ("unfinished", "write the key unfinished of the entry"),
    ("pump", "write the key pump of the entry"),
    ("repeat", "write the key batch of the entry"),
    ("every", "write the key batch of the entry"),
    ("dry-run", "take it out: a run with it moves nothing"),
];

/// Thing that an entry does. Volumes, names and options are as they were typed: whoever runs the entry checks them as
/// those of a command.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Action {
    /// A dose, or several with a batch.
    Dose {
        /// Name of the pump.
        pump: String,
        /// Volume with its unit; negative in reverse.
        volume: String,
        /// Number and times of several doses.
        batch: Option<Batch>,
    },
    /// The line is filled.
    Prime {
        /// Name of the pump.
        pump: String,
        /// Volume with its unit; negative in reverse.
        volume: String,
    },
    /// Several pumps move by one timetable.
    Rack {
        /// Name of the rack in the configuration, or path of its file.
        rack: String,
    },
}

/// The doses of a batch.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Batch {
    /// Number of doses, 1 to 100,000.
    pub repeat: u32,
    /// Time from the begin of a dose to the begin of the next; without it each follows the one before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub every: Option<Duration>,
}

/// The value of an option.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Setting {
    /// An option with a value, as it was typed.
    Text(String),
    /// An option without a value.
    On,
}

impl Serialize for Setting {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Text(text) => serializer.serialize_str(text),
            Self::On => serializer.serialize_bool(true),
        }
    }
}

impl Action {
    /// Keys of an action, of which an entry has one.
    const DONE: [&str; 3] = ["dose", "prime", "rack"];

    pub(super) fn read(keys: &Keys<'_>) -> Result<Self, ScheduleError> {
        let done = keys.among(&Self::DONE);
        let [key] = done.as_slice() else {
            let allowed = "one of dose, prime, rack";
            return Err(match done.as_slice() {
                [] => keys.missing("what it does", allowed),
                [first, ..] => keys.wrong(
                    first,
                    format!("beside {}", done[1..].join(" and ")),
                    allowed,
                    "make an entry of each",
                ),
            });
        };
        if *key != "dose" && keys.has("batch") {
            return Err(keys.wrong("batch", format!("beside {key}"), "batch beside dose", "take it out"));
        }
        if *key == "rack" {
            if keys.has("pump") {
                let instead = "take pump out: the rack names its pumps";
                return Err(keys.wrong("pump", "beside rack", "pump beside dose or prime", instead));
            }
            let rack = keys.text("rack", "mix")?.unwrap_or_default();
            return Ok(Self::Rack { rack });
        }
        let allowed = "name of a pump, as in the configuration";
        let pump = keys.text("pump", "ph-down")?.ok_or_else(|| keys.missing("pump", allowed))?;
        let volume = keys.text(key, "25mL")?.unwrap_or_default();
        if *key == "prime" {
            return Ok(Self::Prime { pump, volume });
        }
        Ok(Self::Dose { pump, volume, batch: Batch::read(keys)? })
    }

    /// Writes the keys of the action.
    pub(super) fn write<M: SerializeMap>(&self, map: &mut M) -> Result<(), M::Error> {
        match self {
            Self::Dose { pump, volume, batch } => {
                map.serialize_entry("pump", pump)?;
                map.serialize_entry("dose", volume)?;
                batch.as_ref().map_or(Ok(()), |batch| map.serialize_entry("batch", batch))
            }
            Self::Prime { pump, volume } => {
                map.serialize_entry("pump", pump)?;
                map.serialize_entry("prime", volume)
            }
            Self::Rack { rack } => map.serialize_entry("rack", rack),
        }
    }

    /// Returns the name of the one pump that moves; `None` for a rack.
    pub fn pump(&self) -> Option<&str> {
        match self {
            Self::Dose { pump, .. } | Self::Prime { pump, .. } => Some(pump),
            Self::Rack { .. } => None,
        }
    }
}

impl Batch {
    fn read(keys: &Keys<'_>) -> Result<Option<Self>, ScheduleError> {
        let Some(value) = keys.get("batch") else { return Ok(None) };
        let Value::Table(table) = value else {
            let instead = "write the number of its doses, and their times if they have some";
            let allowed = "a table, as { repeat = 20, every = \"30s\" }";
            return Err(keys.wrong("batch", shown(value), allowed, instead));
        };
        let batch = Keys::new(keys.place.clone(), table, &["repeat", "every"])
            .map_err(|error| error.inside("batch"))?;
        let allowed = format!("whole numbers from 1 to {MOST_DOSES}");
        let Some(repeat) = batch.get("repeat") else { return Err(keys.missing("repeat of batch", allowed)) };
        let number = repeat.as_integer().filter(|number| (1..=MOST_DOSES).contains(number));
        let number = number.and_then(|number| u32::try_from(number).ok());
        let wrong =
            || keys.wrong("repeat of batch", shown(repeat), allowed, "write it without quotes, as 20");
        let every = Duration::read(&batch, "every", "1s", "1d").map_err(|error| error.inside("batch"))?;
        Ok(Some(Self { repeat: number.ok_or_else(wrong)?, every }))
    }
}

/// Reads the options of an entry: names of the command's options with their values as texts.
pub(super) fn options(keys: &Keys<'_>) -> Result<BTreeMap<String, Setting>, ScheduleError> {
    let Some(value) = keys.get("options") else { return Ok(BTreeMap::new()) };
    let Value::Table(table) = value else {
        let allowed = "a table, as { rate = \"5mL/s\", smooth = true }";
        return Err(keys.wrong("options", shown(value), allowed, "write the options in braces"));
    };
    let mut options = BTreeMap::new();
    for (name, value) in table {
        let key = format!("{name} of options");
        let letters = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        if !name.starts_with(|c: char| c.is_ascii_lowercase()) || !name.chars().all(letters) {
            let allowed = "names of a-z, 0-9 and -";
            return Err(keys.wrong(
                "options",
                name,
                allowed,
                "write the option's name without dashes before it",
            ));
        }
        if let Some((_, instead)) = NO_OPTIONS.iter().find(|(known, _)| known == name) {
            let allowed = "options of a motion that are no keys of the entry";
            return Err(keys.wrong("options", name, allowed, *instead));
        }
        let setting = match value {
            Value::Boolean(true) => Setting::On,
            Value::String(_) => Setting::Text(keys.text_of(&key, value, "5mL/s")?),
            _ => {
                let instead = "write a value in quotes with its unit, or true for an option without one";
                return Err(keys.wrong(&key, shown(value), "a text, true", instead));
            }
        };
        options.insert(name.clone(), setting);
    }
    Ok(options)
}
