//! Entries as they are written, in the schema that they are read in.

use jiff::tz::TimeZone;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::days::time_text;
use super::entry::Entry;
use super::policy::{IfBusy, IfUnfinished};
use super::timing::Timing;

/// Writes the keys of `schedule/1`. A key that has its default is left out.
impl Serialize for Entry {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("name", self.name())?;
        if !self.enabled() {
            map.serialize_entry("enabled", &false)?;
        }
        let days = match self.timing() {
            Timing::At { times, days } => {
                let texts: Vec<String> = times.iter().map(|time| time_text(*time)).collect();
                map.serialize_entry("at", &texts)?;
                days.words()
            }
            Timing::Window { every, between, days } => {
                map.serialize_entry("every", every)?;
                map.serialize_entry("between", &between.map(time_text))?;
                days.words()
            }
            Timing::Interval { every, anchor } => {
                map.serialize_entry("every", every)?;
                map.serialize_entry("anchor", &format!("{} {}", anchor.date(), time_text(anchor.time())))?;
                None
            }
        };
        if let Some((key, words)) = days {
            map.serialize_entry(key, &words)?;
        }
        for (key, date) in [("from", self.season.from), ("until", self.season.until)] {
            if let Some(date) = date {
                map.serialize_entry(key, &date.to_string())?;
            }
        }
        if let Some(name) = self.own_zone.as_ref().and_then(TimeZone::iana_name) {
            map.serialize_entry("zone", name)?;
        }
        if let Some(within) = self.missed_within() {
            map.serialize_entry("missed", &self.missed())?;
            map.serialize_entry("missed_within", within)?;
        }
        if self.unfinished() != IfUnfinished::default() {
            map.serialize_entry("unfinished", &self.unfinished())?;
        }
        if self.busy() != IfBusy::default() {
            map.serialize_entry("busy", &self.busy())?;
        }
        self.action().write(&mut map)?;
        if !self.options().is_empty() {
            map.serialize_entry("options", self.options())?;
        }
        map.end()
    }
}
