//! The schedule is edited in its file, which stays the one source of truth.

use std::fs;

use pump_bench::files::Staged;
use serde_json::{Value, json};
use tokio::runtime::Handle;

use super::doubt::{doubt, doubted_key};
use super::edit::{Keys, added, changed, removed};
use super::loaded::{LARGEST, Loaded};
use super::refusal::EditError;
use super::runner::{Runner, RunnerError};
use crate::schedule::{Entry, Schedule};

/// Runs that are shown of an entry.
const SHOWN: usize = 3;

/// Change of one entry.
#[derive(Debug)]
pub enum Edit {
    /// One more entry of these keys.
    Add(Keys),
    /// These are the keys of the entry of this name from now on.
    Change(String, Keys),
    /// The entry of this name is taken out.
    Remove(String),
}

impl Runner {
    /// Edits the file if it is still the one with this tag, and has it in force at once. `dry` checks the edit, and
    /// writes nothing. Returns the entry and its next runs. It tries the entry out, so it belongs on a thread that may
    /// wait, within the runtime of the service.
    ///
    /// # Errors
    ///
    /// [`EditError`] with the file's own words. Nothing has changed then.
    pub fn edit(&self, edit: &Edit, tag: &str, dry: bool) -> Result<Value, EditError> {
        // A run that is due now belongs to the schedule before.
        self.step()?;
        let text = {
            let mut loaded = self.loaded();
            self.reload(&mut loaded);
            self.check_text(&loaded)?;
            if loaded.tag() != tag {
                return Err(EditError::Changed);
            }
            edited(&loaded, edit)?
        };
        let schedule = Schedule::read(&text, &Loaded::machine_zone())?;
        let name = entry_name(edit);
        let entry = schedule.entry(&name);
        if let Some(entry) = entry.filter(|entry| entry.enabled())
            && let Some(why) = Handle::current().block_on(doubt(entry, self.service()))
        {
            let key = Handle::current().block_on(doubted_key(entry, self.service()));
            return Err(EditError::Doubt { entry: name, key, why });
        }
        if text.len() as u64 > LARGEST {
            return Err(EditError::Large);
        }
        // The trial of the entry took its time, in which others may have edited the file.
        let mut loaded = self.loaded();
        if loaded.tag() != tag {
            return Err(EditError::Changed);
        }
        if !dry {
            self.check_text(&loaded)?;
            Staged::new(self.path(), |file| file.write_all(text.as_bytes()))?.put()?;
            *loaded = match Loaded::read(self.path(), self.service().history(), self.now()) {
                Ok(read) => read.with_trials_of(&loaded),
                Err(RunnerError::History(error)) => return Err(EditError::History(error)),
                Err(error) => return Err(EditError::Unusable(error)),
            };
            let done = match edit {
                Edit::Add(_) => "was added",
                Edit::Change(..) => "was changed",
                Edit::Remove(_) => "was removed",
            };
            self.service().note("schedule", None, &format!("entry {name} {done}; the schedule is in force"));
        }
        let next = entry.map(|entry| self.next_runs(&schedule, entry)).unwrap_or_default();
        let (file, tag) = (self.path().display().to_string(), loaded.tag());
        Ok(json!({"schema": "schedule-edit/1", "entry": entry, "next": next, "file": file, "etag": tag}))
    }

    /// Refuses an edit while the file is not the text that is in force.
    fn check_text(&self, loaded: &Loaded) -> Result<(), EditError> {
        if loaded.error.is_none() && fs::read_to_string(self.path()).is_ok_and(|text| text == loaded.text) {
            return Ok(());
        }
        match Loaded::read_unkept(self.path()) {
            Ok(_) => Err(EditError::Changed),
            Err(error) => Err(EditError::Unusable(error)),
        }
    }

    /// The next runs of an entry.
    fn next_runs(&self, schedule: &Schedule, entry: &Entry) -> Vec<Value> {
        let mut after = self.now();
        let mut runs = Vec::new();
        while runs.len() < SHOWN
            && let Some(due) = schedule.next(entry.name(), after)
        {
            after = due.planned;
            runs.push(json!({"at": due.planned, "words": due.to_string()}));
        }
        runs
    }
}

/// The name of the entry after an edit; the old name of one that is taken out.
fn entry_name(edit: &Edit) -> String {
    let told = |keys: &Keys| keys.get("name").and_then(Value::as_str).map(|name| name.trim().to_owned());
    match edit {
        Edit::Add(keys) => told(keys).unwrap_or_default(),
        Edit::Change(name, keys) => told(keys).unwrap_or_else(|| name.clone()),
        Edit::Remove(name) => name.clone(),
    }
}

/// The text of the file after an edit.
fn edited(loaded: &Loaded, edit: &Edit) -> Result<String, EditError> {
    let text = &loaded.text;
    let find = |name: &str| {
        let found = loaded.schedule.entries().iter().position(|entry| entry.name() == name);
        found.ok_or_else(|| EditError::Missing(name.to_owned()))
    };
    match edit {
        Edit::Add(keys) => added(text, keys),
        Edit::Remove(name) => removed(text, find(name)?),
        Edit::Change(name, keys) => {
            let index = find(name)?;
            let mut keys = keys.clone();
            keys.entry("name").or_insert_with(|| name.as_str().into());
            // The file's own rules read the new keys; only values with another meaning are written.
            let whole = changed(text, index, &keys, |key| !keys.contains_key(key))?;
            let read = Schedule::read(&whole, &Loaded::machine_zone())?;
            let [old, new] = [&loaded.schedule, &read].map(|schedule| keys_of(&schedule.entries()[index]));
            let is_new = |(key, value): &(&String, &Value)| old.get(*key) != Some(*value);
            let set: Keys =
                new.iter().filter(is_new).map(|(key, value)| (key.clone(), value.clone())).collect();
            changed(text, index, &set, |key| old.contains_key(key) && !new.contains_key(key))
        }
    }
}

/// The keys of an entry, without those that have their defaults.
fn keys_of(entry: &Entry) -> Keys {
    match json!(entry) {
        Value::Object(keys) => keys,
        _ => Keys::new(),
    }
}
