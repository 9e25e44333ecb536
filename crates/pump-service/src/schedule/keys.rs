//! The keys of one TOML table, each read once and with its own refusal.

use std::fmt::Display;

use toml::{Table, Value};

use super::error::{Place, ScheduleError};

/// A table of the file, and the part of the schedule that it is.
pub(super) struct Keys<'a> {
    pub place: Place,
    table: &'a Table,
}

impl<'a> Keys<'a> {
    /// Takes a table whose keys are among `known`.
    pub(super) fn new(place: Place, table: &'a Table, known: &[&str]) -> Result<Self, ScheduleError> {
        match table.keys().find(|key| !known.contains(&key.as_str())) {
            Some(key) => {
                Err(ScheduleError::UnknownKey { place, key: key.clone(), allowed: known.join(", ") })
            }
            None => Ok(Self { place, table }),
        }
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    pub(super) fn get(&self, key: &str) -> Option<&'a Value> {
        self.table.get(key)
    }

    /// Returns the keys of `keys` that the table has.
    pub(super) fn among(&self, keys: &[&'static str]) -> Vec<&'static str> {
        keys.iter().copied().filter(|key| self.has(key)).collect()
    }

    pub(super) fn missing(&self, key: &str, allowed: impl Display) -> ScheduleError {
        ScheduleError::MissingKey {
            place: self.place.clone(),
            key: key.to_owned(),
            allowed: allowed.to_string(),
        }
    }

    pub(super) fn wrong(
        &self,
        key: &str,
        value: impl Display,
        allowed: impl Display,
        instead: impl Display,
    ) -> ScheduleError {
        ScheduleError::Value {
            place: self.place.clone(),
            key: key.to_owned(),
            value: value.to_string(),
            allowed: allowed.to_string(),
            instead: instead.to_string(),
        }
    }

    /// Reads a text that is not blank. TOML's own dates and times are texts too.
    pub(super) fn text(&self, key: &str, example: &str) -> Result<Option<String>, ScheduleError> {
        self.get(key).map(|value| self.text_of(key, value, example)).transpose()
    }

    pub(super) fn text_of(&self, key: &str, value: &Value, example: &str) -> Result<String, ScheduleError> {
        let text = match value {
            Value::String(text) => text.trim().to_owned(),
            Value::Datetime(time) => time.to_string(),
            _ => String::new(),
        };
        let is_plain = !text.is_empty() && !text.contains(char::is_control);
        let way = if value.is_str() { "write one" } else { "write it in quotes" };
        let instead = format!("{way}, as \"{example}\"");
        if is_plain { Ok(text) } else { Err(self.wrong(key, shown(value), "a text of one line", instead)) }
    }

    /// Reads one text or a list of texts. The list has an element or more.
    pub(super) fn texts(&self, key: &str, example: &str) -> Result<Option<Vec<String>>, ScheduleError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let Value::Array(list) = value else {
            return Ok(Some(vec![self.text_of(key, value, example)?]));
        };
        if list.is_empty() {
            let instead = "write one or take the key out";
            return Err(self.wrong(key, "[]", format!("one or more, as [\"{example}\"]"), instead));
        }
        list.iter().map(|value| self.text_of(key, value, example)).collect::<Result<_, _>>().map(Some)
    }

    pub(super) fn switch(&self, key: &str) -> Result<Option<bool>, ScheduleError> {
        self.get(key).map_or(Ok(None), |value| match value {
            Value::Boolean(on) => Ok(Some(*on)),
            _ => Err(self.wrong(key, shown(value), "true, false", "write one of them without quotes")),
        })
    }

    /// Reads a word that stands for one of a few choices.
    pub(super) fn choice<T: Copy>(
        &self,
        key: &str,
        choices: &[(&'static str, T)],
    ) -> Result<Option<T>, ScheduleError> {
        let Some(text) = self.text(key, choices[0].0)? else { return Ok(None) };
        let found = choices.iter().find(|(word, _)| *word == text);
        let words: Vec<&str> = choices.iter().map(|(word, _)| *word).collect();
        found
            .map(|(_, choice)| Some(*choice))
            .ok_or_else(|| self.wrong(key, &text, words.join(", "), "write one of them"))
    }
}

/// A value as an error shows it.
pub(super) fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.escape_debug().to_string(),
        Value::Table(_) => "a table".to_owned(),
        other => other.to_string(),
    }
}
