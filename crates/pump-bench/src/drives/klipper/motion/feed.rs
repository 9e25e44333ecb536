//! The steps of a move from rest to rest: commands on their way, and the steps that the board has made by its clock.

use std::collections::VecDeque;

use crate::drives::klipper::refit::{Refit, RefitError, StepCommand, StepRun, StepTimer};

/// Ticks for which commands are kept after their end, in parts of a second: an index sensor is told later.
const KEPT: u64 = 1;

/// Run of steps that was sent.
#[derive(Debug, Clone, Copy)]
struct Sent {
    /// Steps of the move before it.
    before: u64,
    /// Tick of the board's clock from which its first interval counts.
    from: u64,
    command: StepCommand,
}

impl Sent {
    fn end(&self) -> u64 {
        self.from + self.command.span()
    }

    /// Returns the number of its steps that are due at a tick.
    fn due_at(&self, tick: u64) -> u64 {
        let Some(after) = tick.checked_sub(self.from).and_then(|after| i64::try_from(after).ok()) else {
            return 0;
        };
        let (mut made, mut beyond) = (0, u32::from(self.command.count) + 1);
        while beyond - made > 1 {
            let middle = made.midpoint(beyond);
            let is_due = self.command.due(u16::try_from(middle).unwrap_or(u16::MAX)) <= after;
            *(if is_due { &mut made } else { &mut beyond }) = middle;
        }
        made.into()
    }
}

/// Times of steps.
type Times<'a> = Box<dyn Iterator<Item = f64> + Send + 'a>;

/// Move from rest to rest.
pub(super) struct Feed<'a> {
    refit: Refit<Times<'a>>,
    timer: StepTimer,
    /// Tick of the board's clock at which the times of the refit begin.
    base: u64,
    sent: VecDeque<Sent>,
    /// Run that waits until the board has made all before it.
    held: Option<StepRun>,
    /// Steps of the move that were sent.
    pub(super) pushed: u64,
    /// Tick of the last of them, or of the begin.
    pub(super) ends_at: u64,
    /// Interval before the last of them, in ticks.
    interval: u64,
    /// True once the way to rest was sent, so that no step follows.
    pub(super) is_closed: bool,
    /// Ticks of a second.
    hz: u64,
}

impl<'a> Feed<'a> {
    /// Begins a move at a tick of the board's clock, with the times of its steps in s since then.
    pub(super) fn new(times_s: impl Iterator<Item = f64> + Send + 'a, timer: StepTimer, base: u64) -> Self {
        let times: Times<'a> = Box::new(times_s);
        Self {
            refit: Refit::new(times, timer),
            timer,
            base,
            sent: VecDeque::new(),
            held: None,
            pushed: 0,
            ends_at: base,
            interval: u64::MAX,
            is_closed: false,
            hz: timer.hz() as u64,
        }
    }

    /// Returns the next run of `most` steps at most, with the tick of the board's clock to which its clock of steps is
    /// to be set before. Returns `None` if no step is left, or the board has to make those before it first: `now` is
    /// the tick that its clock has reached for certain.
    pub(super) fn next(
        &mut self,
        most: u64,
        now: u64,
    ) -> Result<Option<(Option<u64>, StepCommand)>, RefitError> {
        let run = match self.held.take() {
            Some(held) => Some(held),
            None => self.refit.next(most)?,
        };
        let Some(run) = run else { return Ok(None) };
        if run.reset.is_some() && now <= self.ends_at && self.pushed > 0 {
            self.held = Some(run);
            return Ok(None);
        }
        let from = self.base + run.from;
        self.note(from, run.command);
        Ok(Some((run.reset.map(|reset| self.base + reset), run.command)))
    }

    fn note(&mut self, from: u64, command: StepCommand) {
        let sent = Sent { before: self.pushed, from, command };
        let before = u64::try_from(command.due(command.count.saturating_sub(1))).unwrap_or(0);
        self.interval =
            if self.pushed == 0 && command.count == 1 { u64::MAX } else { command.span() - before };
        (self.pushed, self.ends_at) = (self.pushed + u64::from(command.count), sent.end());
        self.sent.push_back(sent);
    }

    /// Returns the tick of the step that comes next. `None` if it is not known yet.
    pub(super) fn next_due(&mut self, most: u64) -> Result<Option<u64>, RefitError> {
        if self.held.is_none() {
            self.held = self.refit.next(most)?;
        }
        let first = |run: StepRun| self.base + run.from + u64::from(run.command.interval);
        Ok(self.held.map(first))
    }

    /// Returns the speed at the end of what was sent, in steps/s.
    pub(super) fn speed(&self) -> f64 {
        if self.interval == u64::MAX { 0.0 } else { self.hz as f64 / self.interval.max(1) as f64 }
    }

    /// Has these times follow in place of all steps that were not sent. They are in s since the last one that was.
    pub(super) fn close(&mut self, times_s: impl Iterator<Item = f64> + Send + 'a) {
        let times: Times<'a> = Box::new(times_s);
        (self.refit, self.base, self.held) = (Refit::new(times, self.timer), self.ends_at, None);
        self.is_closed = true;
    }

    /// Returns the steps that are made at a tick of the board's clock.
    pub(super) fn made_at(&self, tick: u64) -> u64 {
        let last = self.sent.iter().rev().find(|sent| sent.from <= tick);
        match (last, self.sent.front()) {
            (Some(last), _) => last.before + last.due_at(tick),
            (None, Some(first)) => first.before,
            (None, None) => self.pushed,
        }
    }

    /// Returns the number of commands that the board may hold at a tick.
    pub(super) fn held_at(&self, tick: u64) -> usize {
        self.sent.iter().rev().take_while(|sent| sent.end() > tick).count()
    }

    /// Forgets the commands that ended long before a tick.
    pub(super) fn forget(&mut self, tick: u64) {
        while self.sent.len() > 1 && self.sent.front().is_some_and(|sent| sent.end() + KEPT * self.hz < tick)
        {
            self.sent.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_counted_by_the_clock_and_a_ramp_follows_the_last_that_was_sent() {
        let timer = StepTimer::new(1_000_000, 10).unwrap();
        let mut feed = Feed::new((1..=100).map(|step| 1e-3 * f64::from(step)), timer, 5_000_000);
        let mut sent = 0;
        while sent < 40 {
            let (_, command) = feed.next(40 - sent, 0).unwrap().unwrap();
            sent += u64::from(command.count);
        }
        assert_eq!((feed.pushed, feed.ends_at), (40, 5_040_000));
        assert_eq!(
            [5_000_000, 5_000_999, 5_010_005, 6_000_000].map(|tick| feed.made_at(tick)),
            [0, 0, 10, 40]
        );
        assert!((feed.speed() - 1000.0).abs() < 2.0, "{}", feed.speed());
        feed.close([2e-3, 5e-3].into_iter());
        while feed.next(u64::MAX, 0).unwrap().is_some() {}
        assert_eq!((feed.pushed, feed.ends_at.abs_diff(5_045_000) <= 2), (42, true));
        assert_eq!(feed.held_at(5_045_100), 0);
        feed.forget(7_000_000);
        assert_eq!(feed.made_at(7_000_000), 42);
    }
}
