//! The constants of a board.
//!
//! Source: Klipper3d/klipper, `docs/Protocol.md`, "Declaring constants".

use std::fmt::{self, Display, Formatter};
use std::ops::RangeInclusive;

use serde_json::Value;

use super::error::DictionaryError;

/// Constant of a board.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Constant {
    /// Whole number.
    Number(i64),
    /// Text, or a number that is not whole.
    Text(String),
}

impl Constant {
    /// Reads a constant. Old firmware gives numbers as text.
    pub(super) fn new(name: &str, value: &Value) -> Result<Self, DictionaryError> {
        match value {
            Value::String(text) => Ok(text.parse().map_or_else(|_| Self::Text(text.clone()), Self::Number)),
            Value::Number(number) => {
                Ok(number.as_i64().map_or_else(|| Self::Text(number.to_string()), Self::Number))
            }
            value => Err(DictionaryError::Entry { entry: "constant", text: format!("{name}: {value}") }),
        }
    }

    /// Returns the number of the constant of this name, which must be in a range.
    pub(super) fn number(&self, name: &str, range: RangeInclusive<u32>) -> Result<u32, DictionaryError> {
        let number = match self {
            Self::Number(number) => u32::try_from(*number).ok().filter(|number| range.contains(number)),
            Self::Text(_) => None,
        };
        number.ok_or_else(|| DictionaryError::Constant {
            name: name.to_owned(),
            value: self.to_string(),
            allowed: format!("{} to {}", range.start(), range.end()),
        })
    }
}

impl Display for Constant {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(to),
            Self::Text(text) => text.fmt(to),
        }
    }
}
