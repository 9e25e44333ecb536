//! Schedules that are refused.

use std::fmt::{self, Display, Formatter};

use thiserror::Error;

/// The part of a schedule that an error speaks of.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The keys beside the entries.
    Schedule,
    /// An entry by its name.
    Entry(String),
    /// An entry without a usable name, by its number in the file, from 1.
    Number(usize),
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Schedule => f.write_str("schedule"),
            Self::Entry(name) => write!(f, "entry `{name}` of the schedule"),
            Self::Number(number) => write!(f, "entry {number} of the schedule"),
        }
    }
}

/// Schedule that is refused. Nothing of it is in force.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ScheduleError {
    /// The text is not TOML.
    #[error("the schedule is not TOML: {message}")]
    Syntax {
        /// Message of the parser, with line and column.
        message: String,
    },
    /// A key has no meaning there.
    #[error("{place}, `{key}` is an unknown key; allowed: {allowed}; correct its spelling or take it out")]
    UnknownKey {
        /// Part of the schedule.
        place: Place,
        /// Key in the file.
        key: String,
        /// Keys that are allowed.
        allowed: String,
    },
    /// A key is missing.
    #[error("{place}, {key} is missing; allowed: {allowed}; add it")]
    MissingKey {
        /// Part of the schedule.
        place: Place,
        /// Key that is missing.
        key: String,
        /// Values that are allowed.
        allowed: String,
    },
    /// A value is not allowed.
    #[error("{place}, {key} is `{value}`; allowed: {allowed}; {instead}")]
    Value {
        /// Part of the schedule.
        place: Place,
        /// Key in the file.
        key: String,
        /// Value in the file.
        value: String,
        /// Values that are allowed.
        allowed: String,
        /// Way out, in words.
        instead: String,
    },
}

impl ScheduleError {
    /// Says that the key stands inside the table `outer` of its entry.
    pub(super) fn inside(mut self, outer: &str) -> Self {
        if let Self::UnknownKey { key, .. } | Self::MissingKey { key, .. } | Self::Value { key, .. } =
            &mut self
        {
            *key = format!("{key} of {outer}");
        }
        self
    }

    /// Returns the part of the schedule that is wrong; `None` if the text is not TOML.
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::Syntax { .. } => None,
            Self::UnknownKey { place, .. } | Self::MissingKey { place, .. } | Self::Value { place, .. } => {
                Some(place)
            }
        }
    }

    /// Returns the key that is wrong or missing.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Syntax { .. } => None,
            Self::UnknownKey { key, .. } | Self::MissingKey { key, .. } | Self::Value { key, .. } => {
                Some(key)
            }
        }
    }

    /// Returns the value that is wrong.
    pub fn value(&self) -> Option<&str> {
        match self {
            Self::Value { value, .. } => Some(value),
            Self::UnknownKey { key, .. } => Some(key),
            _ => None,
        }
    }

    /// Returns the values that are allowed.
    pub fn allowed(&self) -> Option<&str> {
        match self {
            Self::Syntax { .. } => None,
            Self::UnknownKey { allowed, .. }
            | Self::MissingKey { allowed, .. }
            | Self::Value { allowed, .. } => Some(allowed),
        }
    }
}
