//! A schedule: its entries, and their runs over time.

use jiff::Timestamp;
use jiff::tz::TimeZone;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use toml::{Table, Value};

use super::due::{Due, Merged};
use super::entry::Entry;
use super::error::{Place, ScheduleError};
use super::keys::{Keys, shown};
use super::overlap::refuse_overlap;
use super::place::zone;

/// Schema of the file.
const SCHEMA: &str = "schedule/1";

/// Most entries of a schedule.
const MOST_ENTRIES: usize = 1000;

/// The schedule of a laboratory's doses.
///
/// ```
/// use pump_service::schedule::{Schedule, Timestamp, TimeZone};
///
/// let text = r#"
/// schema = "schedule/1"
/// zone = "Europe/Berlin"
/// [[entry]]
/// name = "night"
/// pump = "ph-down"
/// dose = "25mL"
/// at = "02:30"
/// "#;
/// let schedule = Schedule::read(text, &TimeZone::UTC)?;
/// let after: Timestamp = "2026-03-28T12:00:00Z".parse()?;
/// let until: Timestamp = "2026-03-30T12:00:00Z".parse()?;
/// let runs: Vec<String> = schedule.due(after, until).map(|due| due.planned.to_string()).collect();
/// // 02:30 does not exist on 2026-03-29: the run comes at 03:00, the first instant after the gap.
/// assert_eq!(runs, ["2026-03-29T01:00:00Z", "2026-03-30T00:30:00Z"]);
///
/// let refused = Schedule::read(&text.replace("02:30", "25:00"), &TimeZone::UTC).unwrap_err();
/// assert!(refused.to_string().starts_with("entry `night` of the schedule, at is `25:00`; allowed: 00:00 to"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// The default has no entry.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Schedule {
    /// Zone that the schedule names.
    zone: Option<TimeZone>,
    entries: Vec<Entry>,
}

impl Schedule {
    /// Reads and checks the text of a schedule. `machine_zone` is the zone where the schedule and the entry name none.
    ///
    /// # Errors
    ///
    /// [`ScheduleError`] for the first thing that is wrong, with the entry, the key, the value and what is allowed.
    pub fn read(text: &str, machine_zone: &TimeZone) -> Result<Self, ScheduleError> {
        let table: Table = toml::from_str(text)
            .map_err(|error| ScheduleError::Syntax { message: error.to_string().trim_end().to_owned() })?;
        let keys = Keys::new(Place::Schedule, &table, &["schema", "zone", "entry"])?;
        let schema = keys.text("schema", SCHEMA)?.ok_or_else(|| keys.missing("schema", SCHEMA))?;
        if schema != SCHEMA {
            return Err(keys.wrong("schema", schema, SCHEMA, "this program reads no other schema"));
        }
        let zone = zone(&keys)?;
        let mut entries: Vec<Entry> = Vec::new();
        for (place, table) in tables(&keys)?.into_iter().enumerate() {
            let entry = Entry::read(place + 1, table, zone.as_ref().unwrap_or(machine_zone))?;
            if let Some(other) = entries.iter().position(|other| other.name() == entry.name()) {
                return Err(ScheduleError::Value {
                    place: Place::Number(place + 1),
                    key: "name".to_owned(),
                    value: entry.name().to_owned(),
                    allowed: format!("a name that no other entry has, and entry {} has it", other + 1),
                    instead: "rename one of them".to_owned(),
                });
            }
            entries.push(entry);
        }
        refuse_overlap(&entries)?;
        Ok(Self { zone, entries })
    }

    /// Returns the entries in the order of the file.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Returns the entry of this name.
    pub fn entry(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.name() == name)
    }

    /// Lists the planned runs later than `after`, up to and with `until`, in the order of their times. Runs of one
    /// instant come in the order of the file. The list is made while it is read, and takes no memory over time.
    pub fn due(&self, after: Timestamp, until: Timestamp) -> impl Iterator<Item = Due<'_>> + '_ {
        Merged::new(&self.entries, after, until)
    }

    /// Returns the first run of the entry later than `after`; `None` if there is no such entry or it runs no more.
    pub fn next(&self, entry: &str, after: Timestamp) -> Option<Due<'_>> {
        let entry = self.entry(entry)?;
        entry.next(after).map(|(planned, shift)| Due { entry, planned, shift })
    }
}

/// Returns the tables of the entries.
fn tables<'a>(keys: &Keys<'a>) -> Result<Vec<&'a Table>, ScheduleError> {
    let allowed = format!("{MOST_ENTRIES} tables [[entry]] at most");
    let instead = "write each entry below a line [[entry]]";
    let Some(value) = keys.get("entry") else { return Ok(Vec::new()) };
    let wrong = |value: String| keys.wrong("entry", value, &allowed, instead);
    let Value::Array(list) = value else { return Err(wrong(shown(value))) };
    if list.len() > MOST_ENTRIES {
        return Err(wrong(format!("{} entries", list.len())));
    }
    list.iter().map(|value| value.as_table().ok_or_else(|| wrong(shown(value)))).collect()
}

impl Serialize for Schedule {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("schema", SCHEMA)?;
        if let Some(name) = self.zone.as_ref().and_then(TimeZone::iana_name) {
            map.serialize_entry("zone", name)?;
        }
        map.serialize_entry("entry", &self.entries)?;
        map.end()
    }
}
