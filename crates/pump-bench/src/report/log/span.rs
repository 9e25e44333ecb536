//! The span of time of which a log is listed, and the doses that a wrong clock keeps out of it.

use crate::record::{LogEntry, Stamp};

/// Span of time of which doses are listed. It looks at the doses in the order of their numbers, and keeps none.
///
/// A dose counts by the time that the clock of its day showed. A clock that was set back hides doses that were made
/// within the span, and [`Self::left_out`] tells of them. A time that has not come yet is that of a clock that was
/// ahead: no later dose is measured by it.
#[derive(Debug, Clone, Copy)]
pub struct LogSpan {
    since_s: u64,
    until_s: u64,
    now_s: u64,
    /// Time of the dose before, in seconds since 1970.
    before_s: u64,
    /// Dose with the latest time so far that has come.
    latest: Option<(u64, Stamp)>,
    left_out: Option<LeftOut>,
}

/// Place of a dose beside a span.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct LogPlace {
    /// True if the dose is within the span.
    pub is_within: bool,
    /// True if its time is before that of the dose before it: the clock had gone back.
    pub went_back: bool,
}

/// Doses whose times are before a span, although they were made after a dose within it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct LeftOut {
    /// Number of these doses.
    pub doses: u64,
    /// Number of the first of them.
    pub first: u64,
    /// Number of the dose before that one with the latest time.
    pub after: u64,
    /// Time of that dose.
    pub after_time: Stamp,
}

impl LogSpan {
    /// Makes the span from `since_s` up to `until_s`, in seconds since 1970, by a clock that shows `now_s`.
    pub fn new(since_s: u64, until_s: u64, now_s: u64) -> Self {
        Self { since_s, until_s, now_s, before_s: 0, latest: None, left_out: None }
    }

    /// Returns the place of the next dose.
    pub fn look(&mut self, entry: &LogEntry) -> LogPlace {
        let unix_s = entry.time.unix_s;
        let went_back = unix_s < std::mem::replace(&mut self.before_s, unix_s);
        if unix_s <= self.now_s && self.latest.is_none_or(|(_, latest)| latest.unix_s <= unix_s) {
            self.latest = Some((entry.number, entry.time));
        }
        let latest = self.latest.filter(|(_, latest)| unix_s < self.since_s && latest.unix_s >= self.since_s);
        if let Some((after, after_time)) = latest {
            let first = LeftOut { doses: 0, first: entry.number, after, after_time };
            self.left_out.get_or_insert(first).doses += 1;
        }
        LogPlace { is_within: (self.since_s..self.until_s).contains(&unix_s), went_back }
    }

    /// Returns the doses that are left out although they were made within the span. `None` if there are none.
    pub fn left_out(&self) -> Option<LeftOut> {
        self.left_out
    }
}

impl LeftOut {
    /// Tells the doses for people. `since` names the option that leaves them out.
    pub fn told(&self, since: &str) -> String {
        let Self { doses, first, after, after_time } = self;
        let were = match doses {
            1 => format!("1 dose is left out: number {first}, whose time is before {since}"),
            _ => format!(
                "{doses} doses are left out: number {first} and later ones, whose times are before {since}"
            ),
        };
        format!(
            "{were} although dose {after} at {after_time} came first; the clock was wrong at one of them: without \
             {since} every dose is listed"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DAY_S: u64 = 86_400;
    const NOW_S: u64 = 1_795_400_100;

    /// Returns the numbers of the doses within the last two days, and those left out.
    fn last_two_days(times_s: &[u64]) -> (Vec<u64>, Option<LeftOut>) {
        let mut span = LogSpan::new(NOW_S - 2 * DAY_S, u64::MAX, NOW_S);
        let mut within = Vec::new();
        for (number, unix_s) in (1..).zip(times_s) {
            if span.look(&LogEntry::example(number, *unix_s)).is_within {
                within.push(number);
            }
        }
        (within, span.left_out())
    }

    #[test]
    fn a_time_that_has_not_come_yet_hides_no_dose_after_it_and_no_later_call_tells_of_it() {
        let year_ahead = NOW_S + 365 * DAY_S;
        let month_ago = NOW_S - 30 * DAY_S;
        let times = [month_ago, year_ahead, month_ago + 60, month_ago + DAY_S, NOW_S - DAY_S];
        assert_eq!(last_two_days(&times), (vec![2, 5], None));
    }

    #[test]
    fn a_clock_that_was_set_back_is_told_with_the_doses_concerned() {
        let (within, left_out) = last_two_days(&[NOW_S - DAY_S, 60, 120]);
        assert_eq!(within, [1]);
        let told = left_out.unwrap().told("--since");
        assert!(told.starts_with("2 doses are left out: number 2 and later ones"), "{told}");
        assert!(told.contains("although dose 1 at 2026-11-22T02:15:00+00:00 came first"), "{told}");
    }
}
