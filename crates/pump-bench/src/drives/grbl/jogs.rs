//! A plan as a sequence of jogs: as many ahead as keep the board at speed, and no more than were announced.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use super::board::{Board, Heard, OK_LIMIT, POLL};
use super::error::GrblError;
use super::reply::{Reply, State};
use super::scale::Scale;
use crate::drives::Gate;

/// Time at the cruise that is sent ahead of the motor, beyond the way in which it stops, in s: ten polls.
const AHEAD_S: f64 = 0.5;

/// Number of jogs that are sent ahead. grbl plans 15 ahead.
const JOGS_AHEAD: f64 = 8.0;

/// Time without a step after which a board is stopped, in s, beyond twice the time of its next step.
const STALL_S: f64 = 2.0;

/// Steps to make, with their speeds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Task {
    /// Count before the first step.
    pub start: i64,
    /// Direction of the count: 1 if it rises, -1 if it falls.
    pub direction: i64,
    /// Steps in all.
    pub steps: u64,
    /// Steps per second at the cruise.
    pub steps_s: f64,
    /// Steps per second² of the board's ramps.
    pub steps_s2: f64,
}

impl Task {
    /// Returns the count after `made` steps.
    pub(super) fn count_after(&self, made: u64) -> i64 {
        self.start + self.direction * made as i64
    }

    /// Returns the line that jogs to the end of step `last`. `None` if the axis has no coordinate for it.
    fn line(&self, scale: &Scale, last: u64) -> Option<String> {
        let target = scale.text(self.count_after(last))?;
        let feed = feed_text(self.steps_s * 60.0 / scale.steps_per_unit);
        Some(format!("$J=G53G90G21{}{target}F{feed}", scale.axis.letter()))
    }

    /// Returns the number of steps to send ahead of the motor.
    fn ahead(&self) -> u64 {
        let stop = self.steps_s * self.steps_s / (2.0 * self.steps_s2);
        ((stop + AHEAD_S * self.steps_s).ceil() as u64).max(2)
    }

    /// Returns the number of steps of a jog.
    fn jog(&self) -> u64 {
        ((self.ahead() as f64 / JOGS_AHEAD).ceil() as u64).max(1)
    }

    /// Returns the last step of the jog after step `sent`. No jog is shorter than half of the others.
    fn next_end(&self, sent: u64) -> u64 {
        let jog = self.jog();
        if self.steps - sent < jog + jog / 2 { self.steps } else { sent + jog }
    }

    /// Checks that every jog of the task ends on a step, before anything moves.
    pub(super) fn check(&self, scale: &Scale) -> Result<(), GrblError> {
        let mut sent = 0;
        while sent < self.steps {
            sent = self.next_end(sent);
            let count = self.count_after(sent);
            if count.abs() > scale.most_count() || self.line(scale, sent).is_none() {
                return Err(GrblError::Far { count, most: scale.most_count() });
            }
        }
        Ok(())
    }

    /// Returns the time that the watchdog waits for a step.
    fn patience(&self) -> Duration {
        let step_s = 1.0 / self.steps_s + (2.0 / self.steps_s2).sqrt();
        Duration::from_secs_f64(STALL_S + 2.0 * step_s)
    }
}

/// Formats a feed in units/min with at most eight digits, the most that grbl reads.
pub(super) fn feed_text(units_min: f64) -> String {
    let whole = units_min.max(1.0).log10() as usize + 1;
    format!("{units_min:.*}", 7_usize.saturating_sub(whole).min(6))
}

/// End of a sequence of jogs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ended {
    /// The last step was made.
    Done,
    /// The gate broke. The motor may be under way.
    Asked,
}

/// Sequence of jogs under way.
#[derive(Debug)]
pub(super) struct Jogs<'a> {
    pub board: &'a mut Board,
    pub scale: &'a Scale,
    pub task: Task,
    /// Last step that was sent.
    pub sent: u64,
    /// Last step that was reported.
    pub made: u64,
    /// Line that is not acknowledged yet, and the time at which it was sent.
    pub awaited: Option<(String, Instant)>,
    /// Time at which a step was last reported, or at which none were left to make.
    moved: Instant,
    /// True for a probing move, false for jogs.
    pub probing: bool,
    /// Impossible reports in a row.
    pub odd: u32,
    /// Reports in a row of a rest elsewhere than at the last step sent.
    short: u32,
}

impl<'a> Jogs<'a> {
    /// Prepares the jogs of `task`. Sends nothing yet.
    pub(super) fn new(board: &'a mut Board, scale: &'a Scale, task: Task) -> Self {
        Self {
            board,
            scale,
            task,
            sent: 0,
            made: 0,
            awaited: None,
            moved: Instant::now(),
            probing: false,
            odd: 0,
            short: 0,
        }
    }

    /// Makes the steps, or stops where the gate breaks.
    pub(super) fn run(&mut self, gate: &mut Gate<'_>) -> Result<(), GrblError> {
        let asked = self.travel(gate)? == Ended::Asked;
        if asked && self.sent > 0 { self.stop() } else { Ok(()) }
    }

    /// Sends the jogs as the motor comes along.
    fn travel(&mut self, gate: &mut Gate<'_>) -> Result<Ended, GrblError> {
        let mut watched = Instant::now();
        loop {
            if self.awaited.is_none() && self.has_room() {
                if self.announce(gate)?.is_break() {
                    return Ok(Ended::Asked);
                }
                continue;
            }
            if watched.elapsed() >= POLL {
                watched = Instant::now();
                if gate(self.made, self.sent).is_break() {
                    return Ok(Ended::Asked);
                }
            }
            match self.board.listen()? {
                Some(heard) => {
                    if self.take(heard)? == Some(State::Idle) && self.arrived()? {
                        return Ok(Ended::Done);
                    }
                }
                None => self.watch()?,
            }
        }
    }

    /// Returns true if another jog may be sent.
    fn has_room(&self) -> bool {
        let left = self.sent < self.task.steps;
        left && (self.sent == self.made || self.sent - self.made + self.task.jog() <= self.task.ahead())
    }

    /// Asks the gate for the next jog and sends it.
    fn announce(&mut self, gate: &mut Gate<'_>) -> Result<ControlFlow<()>, GrblError> {
        let last = self.task.next_end(self.sent);
        if gate(self.made, last).is_break() {
            return Ok(ControlFlow::Break(()));
        }
        // The gate may have taken its time. A board that was reset meanwhile counts from zero, and must not
        // get this line.
        while let Some(heard) = self.board.hear(Duration::ZERO)? {
            self.take(heard)?;
        }
        let far = GrblError::Far { count: self.task.count_after(last), most: self.scale.most_count() };
        let line = self.task.line(self.scale, last).ok_or(far)?;
        if self.sent == self.made {
            self.moved = Instant::now();
        }
        // From here on the board may have the line, whatever becomes of the write.
        self.sent = last;
        self.board.send(&line)?;
        self.awaited = Some((line, Instant::now()));
        Ok(ControlFlow::Continue(()))
    }

    /// Takes in a message of the board. Returns the state if the message told it.
    pub(super) fn take(&mut self, heard: Heard) -> Result<Option<State>, GrblError> {
        match heard {
            Heard::Status(state, Some(place)) => {
                self.see(place)?;
                match state {
                    // The line that tells the alarm has been lost.
                    State::Alarm => Err(GrblError::Alarm { code: 0 }),
                    state => Ok(Some(state)),
                }
            }
            Heard::Status(_, None) => Ok(None),
            Heard::Reply(Reply::Ok) => {
                self.awaited = None;
                self.short = 0;
                Ok(None)
            }
            Heard::Reply(Reply::Error(code)) => {
                let line = self.awaited.take().map_or_else(String::new, |(line, _)| line);
                Err(GrblError::Refused { line, code })
            }
            Heard::Reply(Reply::Alarm(code)) => Err(GrblError::Alarm { code }),
            Heard::Reply(Reply::Banner(_)) => Err(GrblError::Reset),
            Heard::Reply(_) => Ok(None),
        }
    }

    /// Follows a reported position. A single impossible one is noise; two in a row are an error.
    pub(super) fn see(&mut self, place: f64) -> Result<(), GrblError> {
        let counted = self.scale.count(self.scale.reported_mm(place));
        let travelled = (counted - self.task.start) * self.task.direction;
        match u64::try_from(travelled) {
            Ok(travelled) if (self.made..=self.sent).contains(&travelled) => {
                self.odd = 0;
                if travelled > self.made {
                    self.made = travelled;
                    self.moved = Instant::now();
                }
                Ok(())
            }
            _ if self.odd == 0 => {
                self.odd = 1;
                Ok(())
            }
            _ => {
                let nearest = if travelled < self.made as i64 { self.made } else { self.sent };
                Err(GrblError::Count { counted, expected: self.task.count_after(nearest) })
            }
        }
    }

    /// Returns true if a rest is the end. A rest elsewhere, told twice with nothing outstanding, is an error.
    fn arrived(&mut self) -> Result<bool, GrblError> {
        if self.awaited.is_some() || self.odd > 0 || self.made == self.sent {
            return Ok(self.awaited.is_none() && self.odd == 0 && self.made == self.task.steps);
        }
        self.short += 1;
        if self.short < 2 {
            return Ok(false);
        }
        let counted = self.task.count_after(self.made);
        Err(GrblError::Count { counted, expected: self.task.count_after(self.sent) })
    }

    /// Checks that a silent board still does its work.
    pub(super) fn watch(&self) -> Result<(), GrblError> {
        if let Some((line, since)) = &self.awaited
            && since.elapsed() > OK_LIMIT
        {
            return Err(GrblError::NoOk { line: line.clone(), waited_s: since.elapsed().as_secs_f64() });
        }
        if self.made < self.sent && self.moved.elapsed() > self.task.patience() {
            return Err(GrblError::Stalled { waited_s: self.moved.elapsed().as_secs_f64() });
        }
        Ok(())
    }
}
