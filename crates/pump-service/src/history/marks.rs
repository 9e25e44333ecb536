//! The fate of a dose after its end: it was weighed for a calibration, or accepted while it was unfinished.

use std::collections::BTreeMap;

use rusqlite::params;

use super::error::HistoryError;
use super::history::History;

/// The fate of a dose of a pump's log after its end.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Marks {
    /// True if the dose was weighed for a calibration.
    pub(crate) weighed: bool,
    /// Giver of the order that accepted the dose. `None` if nobody did.
    pub(crate) accepted: Option<String>,
}

impl History {
    /// Records that the dose of this number was weighed for a calibration, or that somebody accepted it.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if it cannot be recorded.
    pub(crate) fn mark(&self, pump: &str, number: u64, marks: &Marks) -> Result<(), HistoryError> {
        self.execute(
            "INSERT INTO marks (pump, number, weighed, accepted) VALUES (?,?,?,?) ON CONFLICT (pump, number) DO UPDATE \
             SET weighed = max(weighed, excluded.weighed), accepted = coalesce(excluded.accepted, accepted)",
            params![pump, number as i64, marks.weighed, marks.accepted],
        )
    }

    /// Returns the marks of a pump's doses, by their numbers in its log.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if the file cannot be read.
    pub(crate) fn marks(&self, pump: &str) -> Result<BTreeMap<u64, Marks>, HistoryError> {
        self.read(|file| {
            file.prepare("SELECT number, weighed, accepted FROM marks WHERE pump = ?")?
                .query_map(params![pump], |row| {
                    let number: i64 = row.get(0)?;
                    Ok((number as u64, Marks { weighed: row.get(1)?, accepted: row.get(2)? }))
                })?
                .collect()
        })
    }
}
