//! One entry of a schedule.

use std::collections::BTreeMap;

use jiff::tz::TimeZone;
use jiff::{SignedDuration, Timestamp};
use toml::Table;

use super::action::{Action, Setting, options};
use super::days::date;
use super::duration::Duration;
use super::error::{Place, ScheduleError};
use super::keys::Keys;
use super::place::{Shift, zone};
use super::policy::{IfBusy, IfMissed, IfUnfinished};
use super::timing::{Season, Timing};

const KEYS: [&str; 21] = [
    "name",
    "enabled",
    "pump",
    "dose",
    "batch",
    "prime",
    "rack",
    "options",
    "at",
    "every",
    "between",
    "anchor",
    "days",
    "dates",
    "from",
    "until",
    "zone",
    "missed",
    "missed_within",
    "unfinished",
    "busy",
];

/// Longest that a run waits for its pump.
const LONGEST_WAIT: SignedDuration = SignedDuration::from_hours(24);

/// An entry: what is done, when, and what happens to a run that does not go by the clock.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    name: String,
    enabled: bool,
    action: Action,
    options: BTreeMap<String, Setting>,
    timing: Timing,
    pub(super) season: Season,
    /// Zone that the entry itself names.
    pub(super) own_zone: Option<TimeZone>,
    /// Zone in which the entry runs.
    zone: TimeZone,
    missed: IfMissed,
    missed_within: Option<Duration>,
    unfinished: IfUnfinished,
    busy: IfBusy,
}

impl Entry {
    /// Keys of an entry in the file, in the order in which a person writes them.
    pub const KEYS: &'static [&'static str] = &KEYS;

    /// Reads the entry of this number. `schedule_zone` is that of an entry which names none.
    pub(super) fn read(
        number: usize,
        table: &Table,
        schedule_zone: &TimeZone,
    ) -> Result<Self, ScheduleError> {
        let name = name(number, table)?;
        let keys = Keys::new(Place::Entry(name.clone()), table, Self::KEYS)?;
        let action = Action::read(&keys)?;
        let timing = Timing::read(&keys)?;
        let season = Season { from: date(&keys, "from")?, until: date(&keys, "until")? };
        if let (Some(from), Some(until)) = (season.from, season.until)
            && until < from
        {
            let allowed = format!("{from}, which is from, or later");
            return Err(keys.wrong(
                "until",
                until,
                allowed,
                "write the first day as from, the last as until",
            ));
        }
        let missed = keys.choice("missed", IfMissed::CHOICES)?.unwrap_or_default();
        let own_zone = zone(&keys)?;
        Ok(Self {
            enabled: keys.switch("enabled")?.unwrap_or(true),
            options: options(&keys)?,
            zone: own_zone.clone().unwrap_or_else(|| schedule_zone.clone()),
            own_zone,
            missed_within: within(&keys, missed)?,
            missed,
            unfinished: keys.choice("unfinished", IfUnfinished::CHOICES)?.unwrap_or_default(),
            busy: keys.choice("busy", IfBusy::CHOICES)?.unwrap_or_default(),
            name,
            action,
            timing,
            season,
        })
    }

    /// Returns the name, which no other entry has.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns true if the entry runs at all.
    pub fn enabled(&self) -> bool {
        self.enabled
    }

    /// Returns what the entry does.
    pub fn action(&self) -> &Action {
        &self.action
    }

    /// Returns the options of the command, each with its value as it was typed.
    pub fn options(&self) -> &BTreeMap<String, Setting> {
        &self.options
    }

    /// Returns the times of the entry.
    pub fn timing(&self) -> &Timing {
        &self.timing
    }

    /// Returns the zone in which the entry runs.
    pub fn zone(&self) -> &TimeZone {
        &self.zone
    }

    /// Returns the choice for missed runs.
    pub fn missed(&self) -> IfMissed {
        self.missed
    }

    /// Returns how late a missed run is made up for at most; `None` if none is.
    pub fn missed_within(&self) -> Option<&Duration> {
        self.missed_within.as_ref()
    }

    /// Returns the choice for a pump whose last dose was interrupted.
    pub fn unfinished(&self) -> IfUnfinished {
        self.unfinished
    }

    /// Returns the choice for a pump that still moves.
    pub fn busy(&self) -> IfBusy {
        self.busy
    }

    /// Returns the first run after `after`, with the change of the clock that moved it. An entry that is not enabled
    /// has none.
    pub fn next(&self, after: Timestamp) -> Option<(Timestamp, Option<Shift>)> {
        if self.enabled { self.timing.next(&self.zone, self.season, after) } else { None }
    }

    /// Returns the instant until which a run that is due since `since` waits for a pump that moves: the entry's next
    /// time, or 24 hours later if that comes first. `None` if the run does not wait. A run that is made up for is due
    /// since the program came back.
    pub fn waits_until(&self, since: Timestamp) -> Option<Timestamp> {
        match self.busy {
            IfBusy::Skip => None,
            IfBusy::Wait => {
                let longest = since.checked_add(LONGEST_WAIT).unwrap_or(Timestamp::MAX);
                Some(self.next(since).map_or(longest, |(next, _)| next.min(longest)))
            }
        }
    }
}

/// Returns the name of the entry of this number.
fn name(number: usize, table: &Table) -> Result<String, ScheduleError> {
    let known: Vec<&str> = table.keys().map(String::as_str).collect();
    let keys = Keys::new(Place::Number(number), table, &known)?;
    let allowed = "1 to 64 of a-z, 0-9, - and _";
    if table.get("name").and_then(toml::Value::as_str).is_some_and(|name| name.trim().is_empty()) {
        return Err(keys.missing("name", allowed));
    }
    let name = keys.text("name", "ph-down")?.ok_or_else(|| keys.missing("name", allowed))?;
    let letters = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
    if (1..=64).contains(&name.len()) && name.chars().all(letters) {
        return Ok(name);
    }
    Err(keys.wrong("name", name, allowed, "write a name as ph-down"))
}

/// Reads the bound of missed runs, which those that are made up for need.
fn within(keys: &Keys<'_>, missed: IfMissed) -> Result<Option<Duration>, ScheduleError> {
    let within = Duration::read(keys, "missed_within", "1min", "7d")?;
    match (missed, &within) {
        (IfMissed::Skip, Some(_)) => {
            let instead = "take it out, or choose which missed runs are made up for";
            Err(keys.wrong(
                "missed_within",
                "beside missed = skip",
                "missed = once or all beside it",
                instead,
            ))
        }
        (IfMissed::Once | IfMissed::All, None) => {
            Err(keys.missing("missed_within", "1min to 7d, how late a missed run may begin"))
        }
        _ => Ok(within),
    }
}
