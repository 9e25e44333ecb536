//! Runs that are due, in the order of their times.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fmt::{self, Display, Formatter};

use jiff::Timestamp;

use super::entry::Entry;
use super::place::Shift;

/// A planned run of an entry. An entry has one run at most at an instant, so that the entry's name and the planned
/// instant name the run on record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Due<'a> {
    /// Entry that runs.
    pub entry: &'a Entry,
    /// Planned instant, in whole seconds.
    pub planned: Timestamp,
    /// Change of the clock that moved the run.
    pub shift: Option<Shift>,
}

/// Writes the name, and the planned time in the entry's zone.
impl Display for Due<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let zone = self.entry.zone();
        let local = zone.to_datetime(self.planned).strftime("%Y-%m-%d %H:%M:%S").to_string();
        write!(f, "{} at {local} {}", self.entry.name(), zone.to_offset(self.planned))?;
        self.shift.map_or(Ok(()), |shift| write!(f, " ({shift})"))
    }
}

/// Runs of several entries, merged. It holds the next run of each entry and nothing else.
#[derive(Debug)]
pub(super) struct Merged<'a> {
    entries: &'a [Entry],
    /// Next run of each entry.
    shifts: Vec<Option<Shift>>,
    next: BinaryHeap<Reverse<(Timestamp, usize)>>,
    until: Timestamp,
}

impl<'a> Merged<'a> {
    pub(super) fn new(entries: &'a [Entry], after: Timestamp, until: Timestamp) -> Self {
        let shifts = vec![None; entries.len()];
        let mut merged = Self { entries, shifts, next: BinaryHeap::with_capacity(entries.len()), until };
        for number in 0..entries.len() {
            merged.advance(number, after);
        }
        merged
    }

    /// Finds the next run of an entry.
    fn advance(&mut self, number: usize, after: Timestamp) {
        if let Some((run, shift)) = self.entries[number].next(after).filter(|(run, _)| *run <= self.until) {
            self.shifts[number] = shift;
            self.next.push(Reverse((run, number)));
        }
    }
}

impl<'a> Iterator for Merged<'a> {
    type Item = Due<'a>;

    fn next(&mut self) -> Option<Due<'a>> {
        let Reverse((planned, number)) = self.next.pop()?;
        let shift = self.shifts[number];
        self.advance(number, planned);
        Some(Due { entry: &self.entries[number], planned, shift })
    }
}
