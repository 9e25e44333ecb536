//! When an entry runs.

use jiff::civil::{Date, DateTime, Time};
use jiff::tz::TimeZone;
use jiff::{SignedDuration, Timestamp};

use super::days::{Days, checked_time, moment};
use super::duration::Duration;
use super::error::ScheduleError;
use super::keys::{Keys, shown};
use super::place::{Shift, place};

/// Most times of day of an entry.
const MOST_TIMES: usize = 288;

/// Times of an entry. A time of day is local time; an interval is time that passes.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Timing {
    /// Times of day.
    At {
        /// Times of day in their order.
        times: Vec<Time>,
        /// Days on which they run.
        days: Days,
    },
    /// An interval inside a window of the day, which begins with the window.
    Window {
        /// Time between two runs.
        every: Duration,
        /// First and last time of day.
        between: [Time; 2],
        /// Days that have the window.
        days: Days,
    },
    /// An interval that counts from one instant, over days and changes of summer time.
    Interval {
        /// Time between two runs.
        every: Duration,
        /// Local time of the first run.
        anchor: DateTime,
    },
}

/// First and last day of an entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Season {
    pub from: Option<Date>,
    pub until: Option<Date>,
}

impl Timing {
    pub(super) fn read(keys: &Keys<'_>) -> Result<Self, ScheduleError> {
        const ALONE: &str = "at; every with between; every with anchor";
        let beside = |key: &str, value: &str, instead: &str| Err(keys.wrong(key, value, ALONE, instead));
        if keys.has("at") {
            if let [extra, ..] = keys.among(&["every", "between", "anchor"])[..] {
                return beside(extra, "beside at", "take one of them out");
            }
            return Ok(Self::At { times: times(keys)?, days: Days::read(keys)? });
        }
        let Some(every) = Duration::read(keys, "every", "1min", "366d")? else {
            return Err(keys.missing("its time", ALONE));
        };
        match keys.among(&["between", "anchor"])[..] {
            ["between"] => Ok(Self::Window { every, between: window(keys)?, days: Days::read(keys)? }),
            ["anchor"] => {
                if let [extra, ..] = keys.among(&["days", "dates"])[..] {
                    let instead = "take it out, or write between in place of anchor";
                    return beside(extra, "beside anchor", instead);
                }
                let anchor = moment(keys, "anchor")?.ok_or_else(|| keys.missing("anchor", ALONE))?;
                Ok(Self::Interval { every, anchor })
            }
            [] => Err(keys.missing("between or anchor", "between beside every; anchor beside every")),
            _ => beside("between", "beside anchor", "take one of them out"),
        }
    }

    /// Returns the first run after `after`. Every run is an instant of whole seconds.
    pub(super) fn next(
        &self,
        zone: &TimeZone,
        season: Season,
        after: Timestamp,
    ) -> Option<(Timestamp, Option<Shift>)> {
        match self {
            Self::At { times, days } => next_on_days(zone, days, season, after, |date| {
                let at = |time: &Time| place(zone, date.to_datetime(*time));
                let next = times.partition_point(|time| at(time).is_some_and(|(run, _)| run <= after));
                at(times.get(next)?)
            }),
            Self::Window { every, between, days } => next_on_days(zone, days, season, after, |date| {
                let (begin, shift) = place(zone, date.to_datetime(between[0]))?;
                let (end, _) = place(zone, date.to_datetime(between[1]))?;
                step(begin, every, shift, after).filter(|(run, _)| *run <= end)
            }),
            Self::Interval { every, anchor } => {
                let midnight = |date: Date| place(zone, date.to_datetime(Time::midnight()));
                let from =
                    season.from.and_then(midnight).map(|(from, _)| from - SignedDuration::from_secs(1));
                let after = from.map_or(after, |from| from.max(after));
                let (begin, shift) = place(zone, *anchor)?;
                let end = season.until.map(|until| until.tomorrow().ok().and_then(midnight));
                let run = step(begin, every, shift, after)?;
                end.is_none_or(|end| end.is_some_and(|(end, _)| run.0 < end)).then_some(run)
            }
        }
    }
}

/// Returns the first run after `after` of those that `run` finds on a day.
fn next_on_days(
    zone: &TimeZone,
    days: &Days,
    season: Season,
    after: Timestamp,
    run: impl Fn(Date) -> Option<(Timestamp, Option<Shift>)>,
) -> Option<(Timestamp, Option<Shift>)> {
    // Runs of earlier dates have passed: a run comes no later than the clock first shows its time or a later one.
    let today = zone.to_datetime(after).date();
    let mut date = season.from.map_or(today, |from| from.max(today));
    loop {
        date = days.first(date).filter(|date| season.until.is_none_or(|until| *date <= until))?;
        if let Some(found) = run(date).filter(|(run, _)| *run > after) {
            return Some(found);
        }
        date = date.tomorrow().ok()?;
    }
}

/// Returns the first instant after `after` of those that follow `begin` every so often.
fn step(
    begin: Timestamp,
    every: &Duration,
    shift: Option<Shift>,
    after: Timestamp,
) -> Option<(Timestamp, Option<Shift>)> {
    if after < begin {
        return Some((begin, shift));
    }
    let steps = after.duration_since(begin).as_secs() / every.seconds() + 1;
    let passed = SignedDuration::from_secs(steps.checked_mul(every.seconds())?);
    Some((begin.checked_add(passed).ok()?, None))
}

/// Reads the times of day, and puts them in their order.
fn times(keys: &Keys<'_>) -> Result<Vec<Time>, ScheduleError> {
    let texts = keys.texts("at", "06:30")?.unwrap_or_default();
    if texts.len() > MOST_TIMES {
        let allowed = format!("{MOST_TIMES} times at most");
        let instead = "write every with between for times at an interval";
        return Err(keys.wrong("at", format!("{} times", texts.len()), allowed, instead));
    }
    let mut times = Vec::new();
    for text in texts {
        let time = checked_time(keys, "at", &text)?;
        if times.contains(&time) {
            return Err(keys.wrong("at", text, "each time once", "take one of them out"));
        }
        times.push(time);
    }
    times.sort();
    Ok(times)
}

/// Reads the window of a day.
fn window(keys: &Keys<'_>) -> Result<[Time; 2], ScheduleError> {
    let allowed = "two times of the same day, the first before the second";
    let value = keys.get("between").map(shown).unwrap_or_default();
    let texts = keys.texts("between", "08:00")?.unwrap_or_default();
    let [begin, end] = texts.as_slice() else {
        return Err(keys.wrong("between", value, allowed, "write them as [\"08:00\", \"20:00\"]"));
    };
    let window = [checked_time(keys, "between", begin)?, checked_time(keys, "between", end)?];
    if window[0] < window[1] {
        return Ok(window);
    }
    let instead = "make two entries of a window over midnight, which end at 23:59:59 and begin at 00:00";
    Err(keys.wrong("between", format!("{begin} to {end}"), allowed, instead))
}
