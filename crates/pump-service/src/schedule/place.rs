//! Times of day on the line of time.

use std::fmt::{self, Display, Formatter};

use jiff::Timestamp;
use jiff::civil::DateTime;
use jiff::tz::{AmbiguousOffset, TimeZone, TimeZoneDatabase};

use super::days::time_text;
use super::error::ScheduleError;
use super::keys::Keys;

/// Change of a zone's clock at the time of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Shift {
    /// The clock jumps over the time. The run comes at the first instant after the gap.
    Gap {
        /// Time that the day does not have.
        asked: DateTime,
    },
    /// The clock shows the time twice. The run comes once, the first time.
    Twice {
        /// Second instant of that time, at which nothing runs.
        second: Timestamp,
    },
}

impl Display for Shift {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gap { asked } => write!(
                f,
                "{} does not exist on {}; the run comes at the first instant after the gap",
                time_text(asked.time()),
                asked.date()
            ),
            Self::Twice { second } => {
                write!(f, "the clock shows this time again at {second}; the run comes once, the first time")
            }
        }
    }
}

/// Returns the instant at which `zone` has the time `asked`. The map never runs backwards: a later time has the same
/// instant or a later one. `None` beyond the range of instants.
pub(super) fn place(zone: &TimeZone, asked: DateTime) -> Option<(Timestamp, Option<Shift>)> {
    match zone.to_ambiguous_timestamp(asked).offset() {
        AmbiguousOffset::Unambiguous { offset } => Some((offset.to_timestamp(asked).ok()?, None)),
        AmbiguousOffset::Fold { before, after } => {
            let second = after.to_timestamp(asked).ok()?;
            Some((before.to_timestamp(asked).ok()?, Some(Shift::Twice { second })))
        }
        AmbiguousOffset::Gap { after, .. } => {
            // By the later offset the time lies before the gap's instant, by less than the gap is long.
            let below = after.to_timestamp(asked).ok()?;
            let gap = zone.following(below).find(|change| change.offset() == after)?;
            Some((gap.timestamp(), Some(Shift::Gap { asked })))
        }
    }
}

/// Reads the zone at `key` by its name in the IANA database that is part of the program.
pub(super) fn zone(keys: &Keys<'_>) -> Result<Option<TimeZone>, ScheduleError> {
    let Some(name) = keys.text("zone", "Europe/Berlin")? else { return Ok(None) };
    let zones = TimeZoneDatabase::bundled();
    let found = zones.get(&name).ok().filter(|zone| !zone.is_unknown() && zone.iana_name().is_some());
    found.map(Some).ok_or_else(|| {
        let sought = name.to_lowercase().replace(' ', "_");
        let like = zones.available().map(|zone| zone.to_string());
        let mut like: Vec<String> =
            like.filter(|zone| sought.len() > 2 && zone.to_lowercase().contains(&sought)).collect();
        like.sort();
        let instead = match like.as_slice() {
            [] => "write a place of the zone, as Europe/Berlin".to_owned(),
            [first, ..] => format!("did you mean {first}?"),
        };
        keys.wrong("zone", &name, "names of the IANA time zone database", instead)
    })
}
