//! The file of a schedule, and the time since which it is in force.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;
use std::time::SystemTime;

use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::runner::RunnerError;
use super::trial::Trial;
use crate::history::History;
use crate::schedule::Schedule;

/// Words of the history that name the schedule in force.
const TEXT: &str = "schedule-text";
const SINCE: &str = "schedule-since";

/// Largest file, in bytes.
pub(super) const LARGEST: u64 = 4 << 20;

/// A schedule that was read.
#[derive(Debug)]
pub(super) struct Loaded {
    /// Text of the file.
    pub(super) text: String,
    pub(super) schedule: Schedule,
    /// Time since which the schedule is in force as it stands.
    pub(super) since: Timestamp,
    /// Time at which its file was written.
    pub(super) written: Option<SystemTime>,
    /// Last trial of each entry that was tried out, by its name.
    pub(super) trials: BTreeMap<String, Trial>,
    /// Reason why the file is not in force as it is now, and what is instead.
    pub(super) error: Option<String>,
}

impl Loaded {
    /// Reads the schedule. One whose text is new is in force from `now` on.
    pub(super) fn read(path: &Path, history: &History, now: Timestamp) -> Result<Self, RunnerError> {
        let (text, schedule, written) = Self::read_unkept(path)?;
        let known = history.word(TEXT)?;
        let since = match history.word(SINCE)?.and_then(|since| since.parse().ok()) {
            Some(since) if known.as_ref() == Some(&text) => since,
            _ => {
                history.keep_word(SINCE, &now.to_string())?;
                history.keep_word(TEXT, &text)?;
                now
            }
        };
        Ok(Self { text, schedule, since, written, ..Self::nothing(now) })
    }

    /// A schedule without entries, for a file that has not been read.
    pub(super) fn nothing(now: Timestamp) -> Self {
        let (text, schedule, trials) = (String::new(), Schedule::default(), BTreeMap::new());
        Self { text, schedule, since: now, written: None, trials, error: None }
    }

    /// Refuses the file as it was `written`, and leaves in force what is. Returns the reason in words.
    pub(super) fn refuse(&mut self, error: &RunnerError, written: Option<SystemTime>) -> String {
        let instead = if self.schedule.entries().is_empty() {
            "no entry runs until the file is mended"
        } else {
            "the schedule before stays in force"
        };
        let text = format!("{error}; {instead}");
        // Told once for each state of the file.
        self.written = written;
        self.error = Some(text.clone());
        text
    }

    /// The time at which a file was written; none without the file.
    pub(super) fn written(path: &Path) -> Option<SystemTime> {
        path.metadata().and_then(|file| file.modified()).ok()
    }

    /// Returns the schedule with the trials of the one before, for entries that are as they were: only a trial takes a
    /// doubt away.
    pub(super) fn with_trials_of(self, before: &Self) -> Self {
        let stays = |name: &str| {
            let [old, new] = [before, &self].map(|loaded| loaded.schedule.entry(name));
            old == new
        };
        let kept = before.trials.iter().filter(|(name, _)| stays(name));
        let trials = kept.map(|(name, trial)| (name.clone(), trial.clone())).collect();
        Self { trials, ..self }
    }

    /// Returns the reason why the runs of an entry would be refused, as its last trial found.
    pub(super) fn doubt(&self, name: &str) -> Option<&str> {
        self.trials.get(name)?.doubt.as_deref()
    }

    /// Reads the file, and has nothing in force.
    pub(super) fn read_unkept(path: &Path) -> Result<(String, Schedule, Option<SystemTime>), RunnerError> {
        let failed = |source| RunnerError::File { path: path.to_owned(), source };
        let file = path.metadata().map_err(failed)?;
        if file.len() > LARGEST {
            return Err(failed(std::io::Error::other("the file is larger than 4 MiB")));
        }
        let text = std::fs::read_to_string(path).map_err(failed)?;
        let schedule = Schedule::read(&text, &Self::machine_zone())
            .map_err(|source| RunnerError::Schedule { path: path.to_owned(), source: Box::new(source) })?;
        Ok((text, schedule, file.modified().ok()))
    }

    /// The zone of entries that name none, in a file that names none.
    pub(super) fn machine_zone() -> TimeZone {
        TimeZone::system()
    }

    /// The tag of the text, which another text has not.
    pub(super) fn tag(&self) -> String {
        let mut hasher = DefaultHasher::new();
        self.text.hash(&mut hasher);
        format!("{:016x}", hasher.finish())
    }
}
