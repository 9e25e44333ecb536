//! Runs that a service makes now, and those that it reports as missed.

use jiff::{SignedDuration, Timestamp};

use super::due::Due;
use super::entry::Entry;
use super::policy::IfMissed;
use super::schedule::Schedule;

/// A run that begins sooner than this after its time is on time. The shortest interval of an entry is as long, so no
/// more than one run of an interval is on time.
const ON_TIME: SignedDuration = SignedDuration::from_secs(60);

/// Time over which missed runs are counted.
const COUNTED: SignedDuration = SignedDuration::from_hours(366 * 24);

/// The runs that a service makes or leaves out at one instant.
///
/// The planned instant of each run and [`Missed::last`] belong on record before anything moves: a run that is on
/// record is neither made nor reported again.
#[derive(Debug, Clone, PartialEq)]
pub struct Catchup<'a> {
    /// Runs to make now, in the order of their planned times.
    pub run: Vec<Due<'a>>,
    /// Missed runs that are not made up for, an element for each entry that has some.
    pub missed: Vec<Missed<'a>>,
    /// Entries whose record is later than now: the clock was set back.
    pub ahead: Vec<Ahead<'a>>,
}

/// Runs of one entry that are missed for good.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Missed<'a> {
    /// Entry that missed them.
    pub entry: &'a Entry,
    /// Number of missed runs, counted over 366 days.
    pub count: u64,
    /// First of these runs.
    pub first: Timestamp,
    /// Last of these runs.
    pub last: Timestamp,
}

/// An entry whose record is later than now. It does not run again before that time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ahead<'a> {
    /// Entry that waits.
    pub entry: &'a Entry,
    /// Last planned time on record.
    pub recorded: Timestamp,
}

impl Schedule {
    /// Says what runs at `now`, what was missed, and which entries wait for a clock that was set back.
    ///
    /// `recorded` returns the last planned time on record of an entry by its name. `since` is the time from which the
    /// schedule is in force as it stands: what an entry of today would have done before is not missed.
    pub fn catch_up(
        &self,
        recorded: impl Fn(&str) -> Option<Timestamp>,
        since: Timestamp,
        now: Timestamp,
    ) -> Catchup<'_> {
        let mut catchup = Catchup { run: Vec::new(), missed: Vec::new(), ahead: Vec::new() };
        for entry in self.entries().iter().filter(|entry| entry.enabled()) {
            let last = recorded(entry.name()).map_or(since, |last| last.max(since));
            if last > now {
                catchup.ahead.push(Ahead { entry, recorded: last });
            } else {
                catchup.add(entry, last, now);
            }
        }
        // The sort is stable: runs of one instant stay in the order of the file.
        catchup.run.sort_by_key(|due| due.planned);
        catchup
    }
}

impl<'a> Catchup<'a> {
    /// Adds the runs of one entry from `last` to `now`.
    fn add(&mut self, entry: &'a Entry, last: Timestamp, now: Timestamp) {
        let begin = self.run.len();
        let mut missed: Option<Missed<'a>> = None;
        let mut miss = |planned: Timestamp| match &mut missed {
            Some(missed) => (missed.count, missed.last) = (missed.count + 1, planned),
            None => missed = Some(Missed { entry, count: 1, first: planned, last: planned }),
        };
        let counted = now.checked_sub(COUNTED).unwrap_or(Timestamp::MIN);
        let mut after = last.max(counted);
        while let Some((planned, shift)) = entry.next(after).filter(|(planned, _)| *planned <= now) {
            after = planned;
            let late = now.duration_since(planned);
            let within = entry.missed_within().map_or(0, |within| within.seconds());
            if late >= ON_TIME && late > SignedDuration::from_secs(within) {
                miss(planned);
                continue;
            }
            // One run makes up for those before it: the last, which is on time if there is such a run.
            if entry.missed() == IfMissed::Once && self.run.len() > begin {
                self.run.drain(begin..).for_each(|due| miss(due.planned));
            }
            self.run.push(Due { entry, planned, shift });
        }
        self.missed.extend(missed);
    }
}
