//! The rules of an entry, decided minute by minute from what the clock on the wall shows.
//!
//! A time of day is reached when the clock shows it or a later time for the first time. A clock that is set back shows
//! nothing for the first time; a clock that is set forward reaches all times of the gap at once.

const DAY: i64 = 1440;

/// Days of a rule: days of the week from Monday, or dates.
#[derive(Clone, Copy)]
pub(crate) struct Days {
    pub week: [bool; 7],
    pub dates: &'static [&'static str],
}

/// When an entry runs; times of day and intervals in min.
#[derive(Clone, Copy)]
pub(crate) enum Rule {
    At { times: &'static [u16], days: Days, from: Option<&'static str>, until: Option<&'static str> },
    Window { every: i64, between: [u16; 2], days: Days },
    Interval { every: i64, anchor: &'static str, from: Option<&'static str>, until: Option<&'static str> },
}

/// A rule, and the minute from which its interval counts.
pub(crate) struct Sweep {
    rule: Rule,
    begin: Option<i64>,
}

impl Sweep {
    pub(crate) fn new(rule: Rule) -> Self {
        Self { rule, begin: None }
    }

    /// True if the entry runs at this minute. `shown` is the highest local minute that the clock has shown before, and
    /// `now` what it shows.
    pub(crate) fn runs(&mut self, minute: i64, shown: i64, now: i64) -> bool {
        let mut reached = shown + 1..=now;
        match self.rule {
            Rule::At { times, days, from, until } => reached.any(|local| {
                times.contains(&((local % DAY) as u16)) && days.has(local) && within(local, from, until)
            }),
            Rule::Window { every, between, days } => {
                let reached_time = |time: u16| reached.clone().any(|local| local % DAY == i64::from(time));
                let on_day = reached.clone().any(|local| days.has(local));
                if reached_time(between[0]) && on_day {
                    self.begin = Some(minute);
                }
                let runs = self.begin.is_some_and(|begin| (minute - begin) % every == 0);
                if reached_time(between[1]) {
                    self.begin = None;
                }
                runs
            }
            Rule::Interval { every, anchor, from, until } => {
                if reached.contains(&minute_of(anchor)) {
                    self.begin = Some(minute);
                }
                self.begin.is_some_and(|begin| (minute - begin) % every == 0) && within(now, from, until)
            }
        }
    }
}

impl Days {
    fn has(&self, local: i64) -> bool {
        // 1970-01-01 was a Thursday.
        let day = local / DAY;
        self.week[((day + 3) % 7) as usize] || self.dates.iter().any(|date| minute_of(date) / DAY == day)
    }
}

fn within(local: i64, from: Option<&str>, until: Option<&str>) -> bool {
    let day = local / DAY;
    from.is_none_or(|from| minute_of(from) / DAY <= day)
        && until.is_none_or(|until| minute_of(until) / DAY >= day)
}

/// Minutes from 1970-01-01 00:00 to a local date and time, by counting days.
pub(crate) fn minute_of(text: &str) -> i64 {
    let number = |range: std::ops::Range<usize>| text.get(range).map_or(0, |part| part.parse().unwrap());
    let (year, month, day): (i64, i64, i64) = (number(0..4), number(5..7), number(8..10));
    let is_leap = |year: i64| year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let mut days: i64 = (1970..year).map(|year| if is_leap(year) { 366 } else { 365 }).sum();
    let lengths = [31, if is_leap(year) { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    days += lengths.iter().take(month as usize - 1).sum::<i64>() + day - 1;
    days * DAY + number(11..13) * 60 + number(14..16)
}
