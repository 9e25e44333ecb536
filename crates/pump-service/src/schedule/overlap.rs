//! Entries that would move one pump at one time.

use jiff::Timestamp;
use jiff::civil::Time;

use super::due::Due;
use super::entry::Entry;
use super::error::{Place, ScheduleError};
use super::policy::IfBusy;
use super::schedule::Schedule;
use super::timing::Timing;

/// Two entries with runs of one pump at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting<'a> {
    /// Run that begins.
    pub first: Due<'a>,
    /// Run that finds the pump busy: it waits or is left out, as its entry says.
    pub second: Due<'a>,
}

impl Schedule {
    /// Lists the instants later than `after`, up to and with `until`, at which two entries would move one pump.
    ///
    /// Racks are left out: their files name their pumps.
    pub fn meetings(&self, after: Timestamp, until: Timestamp) -> impl Iterator<Item = Meeting<'_>> + '_ {
        let mut instant: Vec<Due<'_>> = Vec::new();
        self.due(after, until).filter_map(move |second| {
            instant.retain(|due| due.planned == second.planned);
            let pump = second.entry.action().pump();
            let first =
                instant.iter().find(|due| pump.is_some() && due.entry.action().pump() == pump).copied();
            instant.push(second);
            first.map(|first| Meeting { first, second })
        })
    }
}

/// Refuses two entries with a time of day of one pump in common, if the later one would be left out each time.
pub(super) fn refuse_overlap(entries: &[Entry]) -> Result<(), ScheduleError> {
    for (place, entry) in entries.iter().enumerate() {
        if entry.busy() == IfBusy::Wait {
            continue;
        }
        for other in &entries[..place] {
            if let Some(time) = common(other, entry) {
                return Err(ScheduleError::Value {
                    place: Place::Entry(entry.name().to_owned()),
                    key: "at".to_owned(),
                    value: super::days::time_text(time),
                    allowed: format!("times at which entry `{}` does not move the same pump", other.name()),
                    instead: "write another time, or busy = \"wait\"".to_owned(),
                });
            }
        }
    }
    Ok(())
}

/// Returns a time of day at which both entries move one pump on some day.
fn common(one: &Entry, two: &Entry) -> Option<Time> {
    let pump = one.action().pump().filter(|pump| two.action().pump() == Some(pump));
    if pump.is_none() || one.zone() != two.zone() || !one.enabled() || !two.enabled() {
        return None;
    }
    let apart = |before: &Entry, after: &Entry| {
        before.season.until.zip(after.season.from).is_some_and(|(until, from)| until < from)
    };
    let (Timing::At { times, days }, Timing::At { times: others, days: other_days }) =
        (one.timing(), two.timing())
    else {
        return None;
    };
    if apart(one, two) || apart(two, one) || !days.meet(other_days) {
        return None;
    }
    times.iter().find(|time| others.contains(time)).copied()
}
