//! The steps of a motion as commands for a board, one after the other.

use super::command::StepCommand;
use super::corridor::Corridor;
use super::error::RefitError;
use super::step_timer::{LONGEST, StepTimer};

/// Most steps of a command, and so of those whose times are known ahead.
const MOST: usize = 1024;

/// A command is as long as it can be but for one part in so many.
const NEARLY: usize = 16;

/// Latest time, in ticks: 2^52. A time in seconds tells single ticks up to it.
const LATEST: f64 = 4_503_599_627_370_496.0;

/// Run of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drives::klipper) struct StepRun {
    /// Tick since the start to which the board's clock of steps is to be set before the command, by
    /// `reset_step_clock`.
    ///
    /// An interval longer than 2^30 ticks has this instead of a command, since a command makes a step after each of
    /// its intervals. The board takes it only once its last step is made, and the tick may have passed by then. The
    /// next step is due 2^29 ticks after that tick at most, and the step before was made 2^29 ticks before it at least.
    pub(in crate::drives::klipper) reset: Option<u64>,
    /// Tick since the start from which the first interval counts: that of the step before, or of the reset.
    pub(in crate::drives::klipper) from: u64,
    /// Steps.
    pub(in crate::drives::klipper) command: StepCommand,
}

impl StepRun {
    /// Returns the tick since the start at which the last step of the run is made.
    pub(in crate::drives::klipper) fn end(&self) -> u64 {
        self.from + self.command.span()
    }

    /// Cuts the run after its first `count` steps.
    fn cut(self, count: u16) -> (Self, Option<Self>) {
        let (command, rest) = self.command.cut(count);
        let first = Self { command, ..self };
        (first, rest.map(|command| Self { reset: None, from: first.end(), command }))
    }
}

/// Refit of a motion to the clock of a board.
///
/// It takes the times of the steps in order, in s since the start, and looks no more than 1024 steps ahead. Every step
/// is made within 2 us of its time. All steps have one direction, which is the caller's to set.
#[derive(Debug)]
pub(in crate::drives::klipper) struct Refit<T> {
    times_s: T,
    timer: StepTimer,
    /// Times of the steps that are known ahead, in ticks since the start.
    due: Vec<f64>,
    /// Time of the last of them, or of the last step made, in ticks since the start.
    known: f64,
    /// Steps in runs that were made, those of the rest included.
    made: u64,
    /// Tick since the start at which the last of these steps is made.
    at: u64,
    /// Number of steps that the next command tries to hold, and its addition.
    guess: (usize, i16),
    /// Rest of a run that was cut.
    rest: Option<StepRun>,
    fault: Option<RefitError>,
}

impl<T: Iterator<Item = f64>> Refit<T> {
    /// Begins with the first step of `times_s`. The board's clock of steps is reset to tick 0, the start.
    pub(in crate::drives::klipper) fn new(times_s: T, timer: StepTimer) -> Self {
        let due = Vec::with_capacity(MOST);
        let guess = (1, 0);
        Self { times_s, timer, due, known: 0.0, made: 0, at: 0, guess, rest: None, fault: None }
    }

    /// Returns the next run, cut to `most` steps, or `None` once all steps are in runs. No step means no run.
    ///
    /// # Errors
    ///
    /// Refuses steps that are closer than the board makes them, and times that do not rise. An error stays.
    pub(in crate::drives::klipper) fn next(&mut self, most: u64) -> Result<Option<StepRun>, RefitError> {
        if most == 0 {
            return Ok(None);
        }
        let run = match self.rest.take() {
            Some(rest) => Some(rest),
            None => self.whole()?,
        };
        let Some(run) = run else { return Ok(None) };
        let (first, rest) = run.cut(u16::try_from(most).unwrap_or(u16::MAX));
        self.rest = rest;
        Ok(Some(first))
    }

    /// Makes a run that is not cut.
    fn whole(&mut self) -> Result<Option<StepRun>, RefitError> {
        let reset = self.reset()?;
        self.at = reset.unwrap_or(self.at);
        let Some(command) = self.best()? else { return Ok(None) };
        let run = StepRun { reset, from: self.at, command };
        let count = usize::from(command.count);
        self.due.drain(..count);
        self.made += u64::from(command.count);
        self.at = run.end();
        self.guess = (count + count / 4 + 1, command.add);
        Ok(Some(run))
    }

    /// Looks `count` steps ahead, as far as there are so many.
    fn look(&mut self, count: usize) -> Result<(), RefitError> {
        while self.due.len() < count.min(MOST) && self.fault.is_none() {
            let Some(time_s) = self.times_s.next() else { break };
            let hz = self.timer.hz();
            let due = time_s * hz;
            if (self.known..LATEST).contains(&due) {
                self.known = due;
                self.due.push(due);
            } else {
                let step = self.made + self.due.len() as u64 + 1;
                let (before_s, latest_s) = (self.known / hz, LATEST / hz);
                self.fault = Some(RefitError::Time { step, time_s, before_s, latest_s });
            }
        }
        self.fault.map_or(Ok(()), Err)
    }

    /// Returns the tick to which the clock of steps is reset if the next step is due too late for an interval. The
    /// step then comes as long after it as the next one after the step.
    fn reset(&mut self) -> Result<Option<u64>, RefitError> {
        self.look(2)?;
        let (shortest, longest) = (f64::from(self.timer.shortest()), f64::from(LONGEST));
        let Some(next) = self.due.first().filter(|due| **due - self.at as f64 > longest) else {
            return Ok(None);
        };
        let most = (longest / 2.0).max(shortest);
        let interval = self.due.get(1).map_or(most, |after| (after - next).clamp(shortest, most));
        Ok(Some((next - interval).round() as u64))
    }

    /// Returns the next command, or `None` if there is no further step.
    ///
    /// Whole ticks keep a command of nearly even intervals short: twice the distance from the plan then allows twice
    /// the steps. Where the bend of the times does, it allows a quarter more. So a command that more than doubles has
    /// the largest distance on its way, and yet ends as near as all others.
    fn best(&mut self) -> Result<Option<StepCommand>, RefitError> {
        let (near, wide) = self.timer.tolerances();
        let Some(command) = self.longest(near)? else { return Ok(None) };
        let doubled = 2 * usize::from(command.count) + 1;
        self.look(doubled)?;
        if near < wide && doubled <= self.due.len() && self.corridor(doubled, wide).fit(command.add).is_some()
        {
            self.guess = (doubled, command.add);
            return self.longest(wide);
        }
        Ok(Some(command))
    }

    /// Returns the command that holds most of the next steps within `tolerance`, nearly, or `None` if there is no
    /// further step.
    fn longest(&mut self, tolerance: f64) -> Result<Option<StepCommand>, RefitError> {
        let mut held: Option<StepCommand> = None;
        let mut fails = MOST + 1;
        let mut count = self.guess.0.min(MOST);
        loop {
            self.look(count)?;
            count = count.min(self.due.len());
            let holds = held.map_or(0, |held| usize::from(held.count));
            if count == holds {
                return Ok(held);
            }
            let guess = held.map_or(self.guess.1, |held| held.add);
            match self.corridor(count, tolerance).fit(guess) {
                Some(command) => held = Some(command),
                None if count == 1 => return Err(self.too_fast()),
                None => fails = count,
            }
            let holds = held.map_or(0, |held| usize::from(held.count));
            if holds > 0 && fails - holds <= (holds / NEARLY).max(1) {
                return Ok(held);
            }
            let doubled = if holds == 0 { 1 } else { 2 * holds };
            count = if fails > MOST { doubled.min(MOST) } else { holds.midpoint(fails) };
        }
    }

    /// Returns the corridor around the next `count` steps.
    fn corridor(&self, count: usize, tolerance: f64) -> Corridor<'_> {
        Corridor {
            due: self.due.get(..count).unwrap_or_default(),
            from: self.at as f64,
            tolerance,
            last_tolerance: self.timer.tolerances().0,
            intervals: (self.timer.shortest(), LONGEST),
        }
    }

    /// Returns the error of a step that comes too soon.
    fn too_fast(&self) -> RefitError {
        let ticks = self.due.first().map_or(0.0, |due| due - self.at as f64);
        RefitError::Fast { step: self.made + 1, ticks, shortest: self.timer.shortest() }
    }
}
