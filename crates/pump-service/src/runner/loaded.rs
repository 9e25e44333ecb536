//! The file of a schedule, and the time since which it is in force.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::SystemTime;

use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::runner::RunnerError;
use crate::history::History;
use crate::schedule::Schedule;

/// Words of the history that name the schedule in force.
const TEXT: &str = "schedule-text";
const SINCE: &str = "schedule-since";

/// Largest file, in bytes.
const LARGEST: u64 = 4 << 20;

/// A schedule that was read.
#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) schedule: Schedule,
    /// Time since which the schedule is in force as it stands.
    pub(super) since: Timestamp,
    /// Time at which its file was written.
    pub(super) written: Option<SystemTime>,
    /// Reasons why the runs of entries would be refused, by their names.
    pub(super) doubts: BTreeMap<String, String>,
    /// True once every entry was tried out.
    pub(super) is_tried: bool,
}

impl Loaded {
    /// Reads the schedule. One whose text is new is in force from `now` on.
    pub(super) fn read(path: &Path, history: &History, now: Timestamp) -> Result<Self, RunnerError> {
        let failed = |source| RunnerError::File { path: path.to_owned(), source };
        let file = path.metadata().map_err(failed)?;
        if file.len() > LARGEST {
            return Err(failed(std::io::Error::other("the file is larger than 4 MiB")));
        }
        let text = std::fs::read_to_string(path).map_err(failed)?;
        let schedule = Schedule::read(&text, &TimeZone::system())
            .map_err(|source| RunnerError::Schedule { path: path.to_owned(), source: Box::new(source) })?;
        let known = history.word(TEXT)?;
        let since = match history.word(SINCE)?.and_then(|since| since.parse().ok()) {
            Some(since) if known.as_ref() == Some(&text) => since,
            _ => {
                history.keep_word(SINCE, &now.to_string())?;
                history.keep_word(TEXT, &text)?;
                now
            }
        };
        Ok(Self { schedule, since, written: file.modified().ok(), doubts: BTreeMap::new(), is_tried: false })
    }
}
