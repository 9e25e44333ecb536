//! The log of a bench, read without holding the pump.

use std::collections::VecDeque;

use crate::bench::Bench;
use crate::record::{LogEntry, LogError, LogLine, LogPlace, Purpose, ShortText, Unfinished, pending};

/// Doses of a bench, oldest first, read one at a time.
pub struct LogReading {
    lines: Box<dyn Iterator<Item = Result<LogLine, LogError>> + Send>,
    /// Place of the last dose that was read.
    last: LogPlace,
    bench: Bench,
    /// Doses that the journal has and the log does not. `None` until the log has ended.
    rest: Option<VecDeque<LogEntry>>,
    /// Line that was read ahead.
    ahead: Option<Result<LogLine, LogError>>,
}

impl std::fmt::Debug for LogReading {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.debug_struct("LogReading").field("last", &self.last).finish_non_exhaustive()
    }
}

impl Bench {
    /// Reads the log: every dose of this pump by this drive, oldest first. Only one dose is in memory at a time.
    ///
    /// A dose that is under way, or that a process left without an end, is not in the log: the status tells it.
    ///
    /// # Errors
    ///
    /// [`LogError`] if the log cannot be opened. Each line tells if it cannot be read.
    pub fn log(&self) -> Result<LogReading, LogError> {
        let lines = Box::new(self.folder().log().lines()?);
        Ok(LogReading { lines, last: LogPlace::default(), bench: self.clone(), rest: None, ahead: None })
    }

    /// Reads the last dose, prime, purge or run of the log, which may be long. `None` if it has none. Retractions,
    /// turns to a mark and the runs of a calibration are left out.
    ///
    /// # Errors
    ///
    /// [`LogError`] if the log cannot be read.
    pub fn last_logged(&self) -> Result<Option<LogEntry>, LogError> {
        let is_asked = |entry: &LogEntry| {
            matches!(entry.purpose, Purpose::Dose | Purpose::Prime | Purpose::Purge | Purpose::Run)
        };
        Ok(self.folder().log().last_of(is_asked)?.map(|(_, entry)| entry))
    }

    /// Reads the motion with this number in the log. `None` if the log does not have it, or cannot be read.
    pub(crate) fn logged(&self, number: u64) -> Option<LogEntry> {
        // The last entries are read first, so that a number that the log lacks ends the search.
        let (_, entry) = self.folder().log().last_of(|entry| entry.number <= number).ok()??;
        Some(entry).filter(|entry| entry.number == number)
    }

    /// Returns the smallest and largest volume, in mL, that an order of a service has delivered, and the numbers of its
    /// doses in the log. What is unfinished counts with its bounds. `None` if the record cannot be read.
    pub fn delivered_by(&self, order: &str) -> Option<((f64, f64), Vec<u64>)> {
        let is_its = |told: &Option<ShortText>| told.is_some_and(|told| told.as_str() == order);
        let (mut least_ml, mut most_ml, mut numbers) = (0.0, 0.0, Vec::new());
        let unfinished = self.story().ok()?.state.and_then(|state| state.unfinished);
        let mut unfinished =
            unfinished.filter(|dose| dose.intent.told.is_some_and(|told| is_its(&told.order)));
        for line in self.log().ok()? {
            let LogLine::Dose(entry) = line.ok()? else { continue };
            if !is_its(&entry.order) {
                continue;
            }
            let (least, most) = self.range_of(&entry, &mut unfinished);
            (least_ml, most_ml) = (least_ml + least, most_ml + most);
            numbers.push(entry.number);
        }
        let rest = unfinished.map_or((0.0, 0.0), |dose| dose.motion_delivered(self.model()).range_ml());
        Some(((least_ml + rest.0, most_ml + rest.1), numbers))
    }

    /// Returns the smallest and largest volume, in mL, of everything that began at `unix_s` or later, in seconds since
    /// 1970, and has a number above `after` in the log. What is unfinished counts with the bounds of its last motion.
    /// `None` if the record cannot be read.
    pub fn delivered_since(&self, unix_s: u64, after: u64) -> Option<(f64, f64)> {
        let (mut least_ml, mut most_ml) = (0.0, 0.0);
        let unfinished = self.story().ok()?.state.and_then(|state| state.unfinished);
        let mut unfinished = unfinished.filter(|dose| dose.intent.unix_s >= unix_s);
        for line in self.log().ok()? {
            let LogLine::Dose(entry) = line.ok()? else { continue };
            if entry.time.unix_s < unix_s || entry.number <= after {
                continue;
            }
            let (least, most) = self.range_of(&entry, &mut unfinished);
            (least_ml, most_ml) = (least_ml + least, most_ml + most);
        }
        let rest = unfinished.map_or((0.0, 0.0), |dose| dose.motion_delivered(self.model()).range_ml());
        Some((least_ml + rest.0, most_ml + rest.1))
    }

    /// Returns the smallest and largest volume of a dose of the log, in mL. A dose that was stopped is in the log, and
    /// stays unfinished: its bounds are those of the unfinished one, which is taken.
    fn range_of(&self, entry: &LogEntry, unfinished: &mut Option<Unfinished>) -> (f64, f64) {
        let own = unfinished.take_if(|dose| dose.intent.unix_s == entry.time.unix_s);
        let own = own.map(|dose| dose.motion_delivered(self.model()).range_ml());
        entry.delivered_range_ml.or(own).unwrap_or((entry.delivered_ml, entry.delivered_ml))
    }
}

impl LogReading {
    /// Returns the doses that the journal has and the log does not: a process may have ended between the two.
    fn pending(&self) -> Result<VecDeque<LogEntry>, LogError> {
        let folder = self.bench.folder();
        let failed = |source| LogError { action: "complete", path: folder.log().path().to_owned(), source };
        let mut rest = VecDeque::new();
        let is_behind = self.bench.story().is_ok_and(|story| story.last_logged() > self.last);
        if is_behind {
            let tell = |entry| {
                rest.push_back(entry);
                Ok(())
            };
            pending(&folder.journal(), self.last, tell).map_err(failed)?;
        }
        Ok(rest)
    }

    /// Reads one line, of the log and then of what the journal alone has.
    fn next_line(&mut self) -> Option<Result<LogLine, LogError>> {
        if self.rest.is_none() {
            match self.lines.next() {
                Some(Ok(LogLine::Dose(entry))) => {
                    self.last = entry.place();
                    return Some(Ok(LogLine::Dose(entry)));
                }
                Some(other) => return Some(other),
                None => match self.pending() {
                    Ok(rest) => self.rest = Some(rest),
                    Err(error) => {
                        self.rest = Some(VecDeque::new());
                        return Some(Err(error));
                    }
                },
            }
        }
        self.rest.as_mut()?.pop_front().map(|entry| Ok(LogLine::Dose(entry)))
    }
}

impl Iterator for LogReading {
    type Item = Result<LogLine, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        let line = self.ahead.take().or_else(|| self.next_line())?;
        self.ahead = self.next_line();
        match (&line, &self.ahead) {
            // The second entry of a dose takes the place of the first.
            (Ok(LogLine::Dose(first)), Some(Ok(LogLine::Dose(second)))) if first.number == second.number => {
                self.ahead.take()
            }
            _ => Some(line),
        }
    }
}
