//! Names for numbers, as those of pins.
//!
//! Source: Klipper3d/klipper, `docs/Protocol.md`, "Declaring enumerations".

use std::collections::BTreeMap;

use serde_json::Value;

use super::error::DictionaryError;

/// Most names that a message lists.
const LISTED_MOST: usize = 8;

/// Names that count up together with their numbers, as PC0 to PC7.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Run {
    /// Name without its number. It is the whole name if that ends with no number.
    stem: String,
    /// Number at the end of the first name. `None` if the name has none.
    first: Option<u32>,
    /// Value of the first name.
    value: u32,
    /// Number of names.
    count: u32,
}

impl Run {
    /// Returns the name at a place of the run.
    fn name(&self, place: u32) -> String {
        let number = self.first.and_then(|first| first.checked_add(place));
        number.map_or_else(|| self.stem.clone(), |number| format!("{}{number}", self.stem))
    }

    /// Returns the value of a name. `None` if the run lacks it.
    fn value_of(&self, name: &str) -> Option<u32> {
        let digits = name.strip_prefix(self.stem.as_str())?;
        let place = match self.first {
            None if digits.is_empty() => 0,
            None => return None,
            Some(first) => digits.parse::<u32>().ok()?.checked_sub(first)?,
        };
        // A name with leading zeros is none of the board's.
        (place < self.count && self.name(place) == name).then(|| self.value.checked_add(place)).flatten()
    }
}

/// Names for the numbers of one kind of parameter.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Enumeration {
    runs: Vec<Run>,
}

impl Enumeration {
    /// Reads an enumeration: names with their values, or with a first value and a count.
    pub(super) fn new(entries: &BTreeMap<String, Value>) -> Result<Self, DictionaryError> {
        let runs = entries.iter().map(|(name, value)| {
            let number = |value: &Value| u32::try_from(value.as_u64()?).ok();
            let run = match value {
                Value::Array(pair) => match pair.as_slice() {
                    [value, count] => number(value).zip(number(count)).and_then(|(value, count)| {
                        let stem = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
                        let first = name[stem.len()..].parse().unwrap_or(0);
                        value.checked_add(count)?;
                        Some(Run { stem: stem.to_owned(), first: Some(first), value, count })
                    }),
                    _ => None,
                },
                value => {
                    let run = |value| Run { stem: name.clone(), first: None, value, count: 1 };
                    number(value).map(run)
                }
            };
            run.ok_or_else(|| DictionaryError::Entry { entry: "name", text: format!("{name}: {value}") })
        });
        Ok(Self { runs: runs.collect::<Result<_, _>>()? })
    }

    /// Returns the value of a name. `None` if no value has it.
    pub(super) fn value_of(&self, name: &str) -> Option<u32> {
        self.runs.iter().find_map(|run| run.value_of(name))
    }

    /// Returns the name of a value. `None` if it has none.
    pub(super) fn name_of(&self, value: u32) -> Option<String> {
        self.runs.iter().find_map(|run| {
            let place = value.checked_sub(run.value)?;
            (place < run.count).then(|| run.name(place))
        })
    }

    /// Returns the names in words, as `PA0 to PA15, PB0 to PB15`.
    pub(super) fn words(&self) -> String {
        let run = |run: &Run| match run.count {
            1 => run.name(0),
            count => format!("{} to {}", run.name(0), run.name(count.saturating_sub(1))),
        };
        let named: Vec<_> = self.runs.iter().filter(|run| run.count > 0).map(run).collect();
        match named.len().checked_sub(LISTED_MOST) {
            None | Some(0) => named.join(", "),
            Some(more) => format!("{} and {more} more", named[..LISTED_MOST].join(", ")),
        }
    }
}
