//! Edits of the schedule that are refused. Nothing has changed then.

use thiserror::Error;

use super::runner::RunnerError;
use crate::history::HistoryError;
use crate::schedule::ScheduleError;

/// Edit of the schedule that is refused. The file is as it was.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EditError {
    /// There is no such entry.
    #[error("the schedule has no entry `{}`", .0.chars().take(80).collect::<String>().escape_debug())]
    Missing(String),
    /// The file is another than the one that was read.
    #[error("the schedule has changed since it was read: read it again, and change it then")]
    Changed,
    /// The file cannot be used as it is.
    #[error("the file of the schedule cannot be used as it is, so correct it first: {0}")]
    Unusable(RunnerError),
    /// The entry is refused as in the file.
    #[error(transparent)]
    Refused(#[from] ScheduleError),
    /// The runs of the entry would be refused.
    #[error("entry `{entry}`: its runs would be refused: {why}")]
    Doubt {
        /// Name of the entry.
        entry: String,
        /// Key of the value that is wrong.
        key: &'static str,
        /// Fault and way out, in words.
        why: String,
    },
    /// A value is null.
    #[error("{0} is null; leave out a key that has no value")]
    Null(String),
    /// The file has its entries in another form.
    #[error(
        "the file has its entries in one list; write each below a line [[entry]], and then edit them here"
    )]
    Inline,
    /// The file is too large.
    #[error("the file would be larger than 4 MiB; take entries out")]
    Large,
    /// The text cannot be edited.
    #[error("the file of the schedule cannot be edited: {0}")]
    Syntax(String),
    /// The file cannot be written.
    #[error("the schedule cannot be written: {0}")]
    Write(#[from] std::io::Error),
    /// The history cannot be used.
    #[error(transparent)]
    History(#[from] HistoryError),
}

impl EditError {
    /// Returns the key of the entry that is wrong; `None` if no single one is.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Refused(error) => error.key(),
            Self::Doubt { key, .. } => Some(key),
            Self::Null(key) => Some(key),
            _ => None,
        }
    }
}
