//! The clock of the schedule.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use jiff::Timestamp;
use pump_bench::report::ErrorKind;
use serde_json::{Value, json};
use thiserror::Error;
use tokio::task::JoinSet;

use super::doubt::doubt;
use super::loaded::Loaded;
use super::run::{KIND, Run, in_turn, order};
use super::trial::{Files, Seen, Trial};
use crate::history::HistoryError;
use crate::schedule::{Entry, Missed, ScheduleError};
use crate::service::{Service, error_report};
use crate::shell::Failed;

/// Time between two looks at the clock and at the file.
const LOOK: Duration = Duration::from_millis(500);

/// Schedule that cannot be run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunnerError {
    /// The file cannot be read.
    #[error("the schedule {} cannot be read: {source}", .path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// The file is refused.
    #[error("schedule {}: {source}", .path.display())]
    Schedule {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: Box<ScheduleError>,
    },
    /// The history cannot be used.
    #[error(transparent)]
    History(#[from] HistoryError),
}

/// Gives the orders of a schedule when they are due.
#[derive(Debug)]
pub struct Runner {
    path: PathBuf,
    service: Service,
    now: fn() -> Timestamp,
    loaded: Mutex<Loaded>,
    /// Entries that wait for a clock that was set back, and were told.
    told_ahead: Mutex<Vec<String>>,
    /// Runs that were begun.
    runs: Mutex<JoinSet<()>>,
}

impl Runner {
    /// Reads the schedule at `path`. `now` is the clock. A file that is refused has no entry run until it is mended:
    /// the pumps need their page and their guard all the same.
    ///
    /// # Errors
    ///
    /// [`HistoryError`] if the history cannot be used.
    pub fn new(path: &Path, service: Service, now: fn() -> Timestamp) -> Result<Self, HistoryError> {
        let written = Loaded::written(path);
        let loaded = match Loaded::read(path, service.history(), now()) {
            Ok(loaded) => loaded,
            Err(RunnerError::History(error)) => return Err(error),
            Err(error) => {
                let mut loaded = Loaded::nothing(now());
                let text = loaded.refuse(&error, written);
                service.note(KIND, None, &text);
                loaded
            }
        };
        let loaded = Mutex::new(loaded);
        let (told_ahead, runs) = (Mutex::default(), Mutex::default());
        Ok(Self { path: path.to_owned(), service, now, loaded, told_ahead, runs })
    }

    /// Gives the orders as they are due, and reads the file anew when it changes, until the service ends.
    pub async fn run(&self) {
        tokio::join!(self.keep_time(), self.keep_doubts());
    }

    /// Waits for the runs that were begun to end and to be told, once the service ends, `longest` at most.
    pub async fn end(&self, longest: Duration) {
        let mut runs = std::mem::take(&mut *self.runs());
        let all = async { while runs.join_next().await.is_some() {} };
        if tokio::time::timeout(longest, all).await.is_err() {
            self.service.note(KIND, None, "the service ended before all runs of the schedule did");
        }
    }

    async fn keep_time(&self) {
        while !self.service.is_ending() {
            self.reload(&mut self.loaded());
            if let Err(error) = self.step() {
                let text = format!("{error}; nothing of the schedule is run meanwhile");
                self.service.note(KIND, None, &text);
                tokio::time::sleep(60 * LOOK).await;
            }
            tokio::time::sleep(LOOK).await;
        }
    }

    /// Tries each entry out once for each state of the entry and of the files that its trial reads. Tells those whose
    /// runs would be refused before the night in which they are due.
    async fn keep_doubts(&self) {
        while !self.service.is_ending() {
            let mut tried = Vec::new();
            for (entry, seen) in self.untried() {
                let doubt = doubt(&entry, &self.service).await;
                if self.service.is_ending() {
                    return;
                }
                tried.push((entry, Trial { seen, doubt }));
            }
            self.take_trials(tried);
            tokio::time::sleep(LOOK).await;
        }
    }

    /// Returns the entries whose last trial may say something else now, with the files as they are.
    fn untried(&self) -> Vec<(Entry, Seen)> {
        let mut files = Files::of(&self.service);
        let loaded = self.loaded();
        let enabled = loaded.schedule.entries().iter().filter(|entry| entry.enabled());
        let seen = enabled.map(|entry| (entry, files.seen(entry)));
        let is_untried = |(entry, seen): &(&Entry, Seen)| {
            !loaded.trials.get(entry.name()).is_some_and(|trial| trial.holds(seen))
        };
        seen.filter(is_untried).map(|(entry, seen)| (entry.clone(), seen)).collect()
    }

    /// Keeps the trials of entries that are as they were tried, and tells the doubts that are new.
    fn take_trials(&self, tried: Vec<(Entry, Trial)>) {
        let mut loaded = self.loaded();
        for (entry, trial) in tried {
            let name = entry.name();
            if loaded.schedule.entry(name) != Some(&entry) {
                continue;
            }
            if self.is_new_doubt(name, trial.doubt.as_deref().unwrap_or_default()) {
                let text = format!(
                    "{name}: its runs will be refused: {}",
                    trial.doubt.as_deref().unwrap_or_default()
                );
                self.service.note(KIND, entry.action().pump(), &text);
            }
            loaded.trials.insert(name.to_owned(), trial);
        }
    }

    /// Keeps the doubt about an entry, empty for none. Returns true if it is another one than was told last, also by an
    /// earlier service.
    fn is_new_doubt(&self, name: &str, doubt: &str) -> bool {
        let (history, word) = (self.service.history(), format!("schedule-doubt {name}"));
        // A history that cannot be read has the doubt told once more.
        let told = history.word(&word).ok().flatten().unwrap_or_default();
        if told == doubt {
            return false;
        }
        if let Err(error) = history.keep_word(&word, doubt) {
            self.service.note(KIND, None, &error.to_string());
        }
        !doubt.is_empty()
    }

    /// Gives the orders that are due now, and tells what was missed.
    pub(super) fn step(&self) -> Result<(), HistoryError> {
        let now = (self.now)();
        let loaded = self.loaded();
        let history = self.service.history();
        let mut recorded = Vec::new();
        for entry in loaded.schedule.entries() {
            recorded.push((entry.name(), history.planned(entry.name())?));
        }
        let of = |name: &str| recorded.iter().find(|(entry, _)| *entry == name).and_then(|(_, last)| *last);
        let catchup = loaded.schedule.catch_up(of, loaded.since, now);
        for missed in &catchup.missed {
            self.tell_missed(missed)?;
        }
        let mut by_pump: BTreeMap<&str, Vec<Run>> = BTreeMap::new();
        for due in &catchup.run {
            // On record before anything moves: it is never made twice.
            history.plan(due.entry.name(), due.planned)?;
            by_pump.entry(due.entry.action().pump().unwrap_or("")).or_default().push(Run::of(due, now));
        }
        for runs in by_pump.into_values() {
            let mut all = self.runs();
            while all.try_join_next().is_some() {}
            all.spawn(in_turn(runs, self.service.clone(), self.now));
        }
        let mut told = self.told_ahead.lock().unwrap_or_else(PoisonError::into_inner);
        told.retain(|name| catchup.ahead.iter().any(|ahead| ahead.entry.name() == name));
        for ahead in &catchup.ahead {
            let name = ahead.entry.name();
            if !told.iter().any(|known| known == name) {
                told.push(name.to_owned());
                let text = format!(
                    "{name} waits until {}, its last run on record: the clock was set back",
                    ahead.recorded
                );
                self.service.note(KIND, ahead.entry.action().pump(), &text);
            }
        }
        Ok(())
    }

    fn tell_missed(&self, missed: &Missed<'_>) -> Result<(), HistoryError> {
        let Missed { entry, count, first, last } = missed;
        let last_recorded = self.service.history().planned(entry.name())?;
        // A run of the entry that is made now comes later in the list, and is on record then.
        if last_recorded.is_none_or(|recorded| recorded < *last) {
            self.service.history().plan(entry.name(), *last)?;
        }
        let text = match count {
            1 => format!("{}: the run of {first} was missed and is left out", entry.name()),
            _ => {
                format!("{}: {count} runs from {first} to {last} were missed and are left out", entry.name())
            }
        };
        self.service.note(KIND, entry.action().pump(), &text);
        let report = error_report(1, ErrorKind::Missed.as_str(), &text);
        self.service.alarm(KIND, Failed::of(&order(entry), report, Some((0.0, 0.0))));
        Ok(())
    }

    /// Reads the file anew if it was written since. A file that is refused leaves the schedule in force as it is.
    pub(super) fn reload(&self, loaded: &mut Loaded) {
        let written = Loaded::written(&self.path);
        if written == loaded.written {
            return;
        }
        match Loaded::read(&self.path, self.service.history(), (self.now)()) {
            Ok(read) => {
                *loaded = read.with_trials_of(loaded);
                self.service.note(KIND, None, "the schedule was read anew and is in force");
            }
            Err(error) => {
                let text = loaded.refuse(&error, written);
                self.service.note(KIND, None, &text);
            }
        }
    }

    /// Returns the schedule in force, its file, the reason why the file as it is now is not in force, and for each
    /// entry its next time and the doubt about it.
    pub fn shown(&self) -> Value {
        let loaded = self.loaded();
        let now = (self.now)();
        let next = loaded.schedule.entries().iter().map(|entry| {
            let due = loaded.schedule.next(entry.name(), now);
            let (at, words) = (due.map(|due| due.planned), due.map(|due| due.to_string()));
            let (zone, doubt) = (entry.zone().iana_name(), loaded.doubt(entry.name()));
            json!({"entry": entry.name(), "at": at, "words": words, "zone": zone, "doubt": doubt})
        });
        let next: Vec<Value> = next.collect();
        let (file, tag) = (self.path.display().to_string(), loaded.tag());
        json!({
            "file": file, "etag": tag, "schedule": loaded.schedule, "next": next, "error": loaded.error
        })
    }

    fn runs(&self) -> MutexGuard<'_, JoinSet<()>> {
        self.runs.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn service(&self) -> &Service {
        &self.service
    }

    pub(super) fn now(&self) -> Timestamp {
        (self.now)()
    }

    pub(super) fn loaded(&self) -> MutexGuard<'_, Loaded> {
        self.loaded.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
