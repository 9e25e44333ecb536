//! Calendar days, and the texts of dates and times of day.

use std::collections::BTreeSet;

use jiff::civil::{Date, DateTime, Time, Weekday};

use super::error::ScheduleError;
use super::keys::Keys;

const WEEK: [(&str, Weekday); 7] = [
    ("mon", Weekday::Monday),
    ("tue", Weekday::Tuesday),
    ("wed", Weekday::Wednesday),
    ("thu", Weekday::Thursday),
    ("fri", Weekday::Friday),
    ("sat", Weekday::Saturday),
    ("sun", Weekday::Sunday),
];

/// Years that a schedule may name.
const YEARS: std::ops::RangeInclusive<i16> = 1970..=2199;

const DATES: &str = "days that the calendar has, of the years 1970 to 2199";
const TIMES: &str = "00:00 to 23:59:59";

/// The days on which an entry runs.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Days {
    /// Every day.
    Every,
    /// Days of the week.
    Week(Vec<Weekday>),
    /// Dates.
    Dates(BTreeSet<Date>),
}

impl Days {
    /// Reads the keys `days` and `dates`, which exclude each other.
    pub(super) fn read(keys: &Keys<'_>) -> Result<Self, ScheduleError> {
        if let Some(texts) = keys.texts("days", "mon")? {
            if keys.has("dates") {
                let instead = "take one of them out";
                return Err(keys.wrong("days", "beside dates", "days or dates", instead));
            }
            let mut days = Vec::new();
            for text in texts {
                let words: Vec<&str> = WEEK.iter().map(|(word, _)| *word).collect();
                let found = WEEK.iter().find(|(word, _)| *word == text);
                let (_, day) =
                    *found.ok_or_else(|| keys.wrong("days", &text, words.join(", "), "write one of them"))?;
                if days.contains(&day) {
                    return Err(keys.wrong("days", text, "each day once", "take one of them out"));
                }
                days.push(day);
            }
            return Ok(Self::Week(days));
        }
        let Some(texts) = keys.texts("dates", "2026-03-01")? else { return Ok(Self::Every) };
        let mut dates = BTreeSet::new();
        for text in texts {
            if !dates.insert(checked_date(keys, "dates", &text)?) {
                return Err(keys.wrong("dates", text, "each date once", "take one of them out"));
            }
        }
        Ok(Self::Dates(dates))
    }

    /// Returns the first of the days that is `date` or later.
    pub(super) fn first(&self, date: Date) -> Option<Date> {
        match self {
            Self::Every => Some(date),
            Self::Week(week) => {
                let mut day = date;
                while !week.contains(&day.weekday()) {
                    day = day.tomorrow().ok()?;
                }
                Some(day)
            }
            Self::Dates(dates) => dates.range(date..).next().copied(),
        }
    }

    /// Returns true if both have a day of the week or a date in common.
    pub(super) fn meet(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Week(one), Self::Week(two)) => one.iter().any(|day| two.contains(day)),
            (Self::Dates(dates), any) | (any, Self::Dates(dates)) => {
                dates.iter().any(|date| any.first(*date) == Some(*date))
            }
            _ => true,
        }
    }

    /// Returns the key and the words of the days in the file; `None` for every day.
    pub(super) fn words(&self) -> Option<(&'static str, Vec<String>)> {
        match self {
            Self::Every => None,
            Self::Week(week) => {
                let word = |day: &Weekday| WEEK.iter().find(|(_, other)| other == day).map(|(word, _)| *word);
                Some(("days", week.iter().filter_map(word).map(str::to_owned).collect()))
            }
            Self::Dates(dates) => Some(("dates", dates.iter().map(Date::to_string).collect())),
        }
    }
}

/// Reads a date at `key`.
pub(super) fn date(keys: &Keys<'_>, key: &str) -> Result<Option<Date>, ScheduleError> {
    keys.text(key, "2026-03-01")?.map(|text| checked_date(keys, key, &text)).transpose()
}

fn checked_date(keys: &Keys<'_>, key: &str, text: &str) -> Result<Date, ScheduleError> {
    date_of(text).ok_or_else(|| keys.wrong(key, text, DATES, "write it as 2026-03-01"))
}

/// Checks a time of day.
pub(super) fn checked_time(keys: &Keys<'_>, key: &str, text: &str) -> Result<Time, ScheduleError> {
    time_of(text).ok_or_else(|| keys.wrong(key, text, TIMES, "write a time of day as 06:30"))
}

/// Reads a date with a time of day at `key`.
pub(super) fn moment(keys: &Keys<'_>, key: &str) -> Result<Option<DateTime>, ScheduleError> {
    let Some(text) = keys.text(key, "2026-03-01 06:30")? else { return Ok(None) };
    let parts = text.split_once([' ', 'T']);
    let moment = parts.and_then(|(date, time)| Some(date_of(date)?.to_datetime(time_of(time.trim())?)));
    let wrong = || {
        let allowed = format!("a date and a time of day: {DATES}, and {TIMES}");
        keys.wrong(key, &text, allowed, "write it as 2026-03-01 06:30")
    };
    moment.map(Some).ok_or_else(wrong)
}

/// Returns the text of a time of day.
pub(super) fn time_text(time: Time) -> String {
    match time.second() {
        0 => format!("{:02}:{:02}", time.hour(), time.minute()),
        second => format!("{:02}:{:02}:{second:02}", time.hour(), time.minute()),
    }
}

/// Returns the numbers of a text such as `06:30`, of these widths.
fn numbers<const N: usize>(text: &str, sign: char, widths: [usize; N]) -> Option<[i16; N]> {
    let mut parts = text.split(sign);
    let mut numbers = [0; N];
    for (number, width) in numbers.iter_mut().zip(widths) {
        let part = parts.next()?;
        let is_plain = part.len() == width && part.bytes().all(|byte| byte.is_ascii_digit());
        *number = part.parse().ok().filter(|_| is_plain)?;
    }
    parts.next().is_none().then_some(numbers)
}

fn date_of(text: &str) -> Option<Date> {
    let [year, month, day] = numbers(text, '-', [4, 2, 2])?;
    let date = Date::new(year, month as i8, day as i8).ok()?;
    YEARS.contains(&year).then_some(date)
}

fn time_of(text: &str) -> Option<Time> {
    // `3:30` says no more and no less than `03:30`.
    let has_short_hour = text.find(':') == Some(1);
    let padded = format!("0{text}");
    let text = if has_short_hour { padded.as_str() } else { text };
    let [hour, minute, second] = match numbers(text, ':', [2, 2]) {
        Some([hour, minute]) => [hour, minute, 0],
        None => numbers(text, ':', [2, 2, 2])?,
    };
    // A leap second is no time of day: `Time` would take 60 from a text.
    Time::new(hour as i8, minute as i8, second as i8, 0).ok()
}
