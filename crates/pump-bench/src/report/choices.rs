//! Choices that reports name by a word.

use pump_ctl::plan::{Finish, LimitedBy, SetBy};
use serde::Serializer;

use crate::words::{words, words_of_reports};

/// For whom a report is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Format {
    /// For people.
    #[default]
    Text,
    /// For programs: one JSON object a line.
    Json,
}

words!(Format { Text = "text", Json = "json" });

/// The basis of a dose's volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumeBasis {
    /// The model alone.
    Model,
    /// The model of a drawing.
    Estimated,
    /// The volumes that were weighed.
    Calibrated,
    /// The balance that ended the dose.
    Weighed,
}

words_of_reports!(VolumeBasis {
    Model = "model",
    Estimated = "estimated",
    Calibrated = "calibrated",
    Weighed = "weighed",
});

/// Serialises where a dose may end by its name.
pub(super) fn finish_word<S: Serializer>(finish: &Finish, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(finish.name())
}

/// Serialises the limit that keeps a dose from being faster by its name.
pub(super) fn limit_word<S: Serializer>(limit: &LimitedBy, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(limit.name())
}

/// Serialises the origin of the smallest pressure that is allowed, by its name; null where no limit is known.
pub(super) fn set_by_word<S: Serializer>(set_by: &Option<SetBy>, to: S) -> Result<S::Ok, S::Error> {
    match set_by {
        Some(set_by) => to.serialize_str(set_by.name()),
        None => to.serialize_none(),
    }
}
