//! A plan as a sequence of jogs: as many ahead as keep the board at speed, and no more than were announced.

mod follower;
mod task;

use std::time::Duration;

pub(super) use self::follower::Follower;
pub(super) use self::task::{Task, feed_text};
use super::board::{Board, Heard, OK_LIMIT, POLL};
use super::error::GrblError;
use super::reply::{BoardState, Reply};
use super::rests::Rests;
use super::scale::Scale;
use crate::drives::{Gate, Leave};

/// Factor by which a motor is faster than it should be at most.
const SURELY: f64 = 1.2;

/// Longest way of a report through the system.
const LATENCY: Duration = Duration::from_millis(20);

/// Time between two looks at the pace of a motor that keeps it.
const PACE: Duration = Duration::from_millis(200);

/// Time after which a motion is stopped, in s, beyond [`LATE`] times the time that it needs.
const LATE_S: f64 = 30.0;

/// Factor by which a motion may take longer than it needs. The feed may be overridden at the board.
const LATE: f64 = 4.0;

/// End of a sequence of jogs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ended {
    /// The last step was made.
    Done,
    /// The gate said stop. The motor may be under way.
    Asked,
}

/// Sequence of jogs under way.
#[derive(Debug)]
pub(super) struct Jogs<'a> {
    pub(super) board: &'a mut Board,
    pub(super) scale: &'a Scale,
    pub(super) task: Task,
    /// Axes that move on one line with this one.
    followers: &'a [Follower],
    /// Last step that was sent.
    pub(crate) sent: u64,
    /// Last step of the lines that were acknowledged.
    pub(crate) acknowledged: u64,
    /// Last step that was reported.
    pub(super) made: u64,
    /// Line that is not acknowledged yet, and the time at which it was sent.
    pub(crate) awaited: Option<(String, Duration)>,
    /// Time at which the first line was sent. Time that the gate takes does not count.
    begun: Option<Duration>,
    /// Time at which a step was last reported, or at which none were left to make.
    moved: Duration,
    /// Time at which the gate was last asked.
    watched: Duration,
    /// True for a probing move, false for jogs.
    pub(super) probing: bool,
    /// Impossible reports in a row.
    odd: u32,
    /// Net steps of the last impossible report, and the time at which it came.
    pub(crate) strayed: Option<(i64, Duration)>,
    /// Time since when `made` is confirmed, at the latest.
    pub(crate) confirmed: Duration,
    /// Alarm that came while the motor was stopped.
    pub(crate) alarm: Option<u16>,
    /// Reports in a row of a rest before the last step that was acknowledged.
    short: u32,
    /// Time and step of the last look at the pace of the motor, and the steps by which it is behind.
    under_way: (Duration, u64),
    behind: f64,
    /// True if a rest that nobody asked for may be the end of the jogs, by a counter that jumped.
    pub(crate) doubtful: bool,
    /// Rests before the end.
    pub(super) rests: Rests,
}

impl<'a> Jogs<'a> {
    /// Prepares the jogs of `task`, with the axes that follow. Sends nothing yet.
    pub(super) fn new(board: &'a mut Board, scale: &'a Scale, task: Task, followers: &'a [Follower]) -> Self {
        let now = board.now();
        Self {
            board,
            scale,
            task,
            followers,
            sent: 0,
            acknowledged: 0,
            made: 0,
            awaited: None,
            begun: None,
            moved: now,
            watched: now,
            probing: false,
            odd: 0,
            strayed: None,
            alarm: None,
            confirmed: now,
            short: 0,
            under_way: (now, 0),
            behind: 0.0,
            doubtful: false,
            rests: Rests::default(),
        }
    }

    /// Makes the steps, or stops where the gate says so.
    pub(super) fn run(&mut self, gate: &mut Gate<'_>) -> Result<(), GrblError> {
        let asked = self.travel(gate)? == Ended::Asked;
        if asked && self.sent > 0 { self.stop_here() } else { Ok(()) }
    }

    /// Sends the jogs as the motor comes along.
    fn travel(&mut self, gate: &mut Gate<'_>) -> Result<Ended, GrblError> {
        loop {
            if self.has_room() && self.announce(gate)? == Leave::Stop {
                return Ok(Ended::Asked);
            }
            if self.asks_to_stop(gate) {
                return Ok(Ended::Asked);
            }
            if let Some(heard) = self.board.listen()?
                && let Some(state) = self.take(heard)?
                && self.arrived(&state)?
            {
                return Ok(Ended::Done);
            }
            self.watch()?;
        }
    }

    /// Returns true while a report is looked into: an impossible position, or a rest that nobody asked for. No line
    /// that moves is sent meanwhile.
    pub(super) fn is_looking(&self) -> bool {
        self.odd > 0 || self.short > 0
    }

    /// Returns true if another jog may be sent.
    fn has_room(&self) -> bool {
        let left = self.awaited.is_none() && self.sent < self.task.steps && !self.is_looking();
        left && (self.sent == self.made || self.sent - self.made + self.task.jog() <= self.task.ahead())
    }

    /// Asks the gate for leave up to step `last`. The time that the gate takes is no delay of the board.
    fn ask_gate(&mut self, gate: &mut Gate<'_>, last: u64) -> Leave {
        let asked = self.board.now();
        let leave = gate(self.made, last);
        let answered = self.board.now();
        self.watched = answered;
        let taken = answered - asked;
        self.moved += taken;
        self.begun = self.begun.map(|begun| begun + taken);
        leave
    }

    /// Asks the gate whenever it is due. Returns true if the motor is to stop.
    pub(super) fn asks_to_stop(&mut self, gate: &mut Gate<'_>) -> bool {
        self.board.now() - self.watched >= POLL && self.ask_gate(gate, self.sent) == Leave::Stop
    }

    /// Notes that lines up to step `last` are sent now. The board may have them, whatever becomes of the
    /// write.
    pub(super) fn note_sent(&mut self, last: u64) {
        let now = self.board.now();
        if self.sent == self.made {
            // A motor that paused was not late.
            self.begun = Some(self.begun.map_or(now, |begun| begun + now.saturating_sub(self.moved)));
            self.moved = now;
            self.under_way = (now, self.made);
            self.behind = 0.0;
        }
        self.sent = last;
    }

    /// Asks the gate for the next jog and sends it with its leave. Without leave the motor goes on with the
    /// jogs that it has, and comes to rest at the end of the last.
    fn announce(&mut self, gate: &mut Gate<'_>) -> Result<Leave, GrblError> {
        let last = self.task.next_end(self.sent);
        let leave = self.ask_gate(gate, last);
        if leave != Leave::Go {
            return Ok(leave);
        }
        self.catch_up()?;
        if self.is_looking() {
            return Ok(Leave::Wait);
        }
        let far = GrblError::Far { count: self.task.count_after(last), most: self.scale.most_count() };
        let line = self.task.line(self.scale, self.followers, last).ok_or(far)?;
        self.note_sent(last);
        // A motor that somebody else stopped rests before this line, and the line would start it again. The
        // report tells that: it is made before the line is obeyed.
        self.board.send_with_question(&line)?;
        self.awaited = Some((line, self.board.now()));
        Ok(Leave::Go)
    }

    /// Takes in what the board said while the gate took its time. A board that was reset meanwhile counts from
    /// zero, and must not get the next line.
    pub(super) fn catch_up(&mut self) -> Result<(), GrblError> {
        let backlog_ends = self.board.now() + POLL;
        while let Some(heard) = self.board.hear(Duration::ZERO)? {
            if let Some(state) = self.take(heard)? {
                self.arrived(&state)?;
            }
            if self.board.now() >= backlog_ends {
                break;
            }
        }
        Ok(())
    }

    /// Takes in a message of the board. Returns the state if the message told it.
    pub(super) fn take(&mut self, heard: Heard) -> Result<Option<BoardState>, GrblError> {
        match heard {
            Heard::Status(state, place) => {
                if let Some(place) = place {
                    self.see(place)?;
                    self.note_rest(&state);
                }
                match state {
                    // The line that tells the alarm has been lost.
                    BoardState::Alarm => Err(GrblError::Alarm { code: 0 }),
                    BoardState::Hold { .. } | BoardState::Door | BoardState::Sleep if self.sent > 0 => {
                        Err(GrblError::StoppedElsewhere { state: state.word() })
                    }
                    state => Ok(Some(state).filter(|_| place.is_some())),
                }
            }
            Heard::Reply(Reply::Ok) => {
                if self.awaited.take().is_some() {
                    self.acknowledged = self.sent;
                }
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

    /// Returns the net steps of the task at a reported position.
    pub(super) fn net(&self, place: f64) -> i64 {
        (self.scale.count(self.scale.reported_mm(place)) - self.task.start) * self.task.direction
    }

    /// Returns the number of steps made if the motor may stand after `net` steps. `None` if no line that was
    /// sent leads there.
    pub(super) fn possible(&self, net: i64) -> Option<u64> {
        let made = u64::try_from(net).ok().filter(|made| (self.made..=self.sent).contains(made))?;
        self.astray_follower(made).is_none().then_some(made)
    }

    /// Returns a follower that is off the line by the board's last report, after `made` steps of this axis.
    fn astray_follower(&self, made: u64) -> Option<&'a Follower> {
        self.followers.iter().find(|follower| !follower.is_on_line(self.board, made, self.task.steps))
    }

    /// Follows a reported position. A single impossible one is noise; two in a row are an error.
    fn see(&mut self, place: f64) -> Result<(), GrblError> {
        let net = self.net(place);
        let now = self.board.now();
        match self.possible(net) {
            Some(made) => {
                self.odd = 0;
                self.confirmed = self.board.reported_since();
                if made > self.made {
                    self.made = made;
                    self.moved = now;
                }
                Ok(())
            }
            // The second look follows at once, before the motor can come where the first is possible.
            None if self.odd == 0 => {
                self.odd = 1;
                self.board.ask()
            }
            None => Err(self.astray(net)),
        }
    }

    /// Notes a rest before the end of the task.
    fn note_rest(&mut self, state: &BoardState) {
        if self.odd == 0 && self.made < self.task.steps {
            let end = self.awaited.as_ref().map(|_| self.acknowledged);
            self.rests.note(state, self.made, end, self.task.steps_s);
        }
    }

    /// Returns the error of a motor that stands after `net` steps, where no line that was sent leads.
    pub(super) fn astray(&mut self, net: i64) -> GrblError {
        self.strayed = Some((net, self.board.now()));
        let nearest = if net < self.made as i64 { self.made } else { self.sent };
        let counted = self.task.start + self.task.direction * net;
        let on_way = u64::try_from(net).ok().filter(|made| (self.made..=self.sent).contains(made));
        if let Some((follower, made)) = on_way.and_then(|made| Some((self.astray_follower(made)?, made))) {
            let task = follower.task;
            let counted = task.start + task.direction * follower.net(self.board).unwrap_or(0);
            let expected = task.count_after(follower.share(made, self.task.steps));
            return GrblError::Count { counted, expected };
        }
        GrblError::Count { counted, expected: self.task.count_after(nearest) }
    }

    /// Returns true if `state` is the rest at the end of the task. A rest before the last step that was
    /// acknowledged is a stop that nobody here asked for.
    ///
    /// A board acknowledges a jog after it has begun it. So no report after that tells a rest, unless the jog
    /// was made or thrown away. A second report shows that the first was no noise: at rest still, or under way
    /// by a jog that came too late.
    ///
    /// A motor that had the time to make all its steps may have made them: then its counter jumped.
    fn arrived(&mut self, state: &BoardState) -> Result<bool, GrblError> {
        let rests = *state == BoardState::Idle;
        if self.odd > 0 {
            return Ok(false);
        }
        let now = self.board.now();
        if !rests && self.short == 0 {
            self.keep_pace(now);
            return Ok(false);
        }
        let followers_rest =
            || self.followers.iter().all(|axis| axis.has_arrived(self.board, self.made, self.task.steps));
        if rests && self.made >= self.acknowledged && followers_rest() {
            self.short = 0;
            return Ok(self.awaited.is_none() && self.made == self.task.steps);
        }
        self.short += 1;
        if self.short < 2 {
            let (since, made) = self.under_way;
            let way = SURELY * self.task.steps_s * (now - since + LATENCY).as_secs_f64() + self.behind;
            self.doubtful = self.acknowledged.saturating_sub(made) as f64 <= way;
            self.board.ask()?;
            return Ok(false);
        }
        Err(GrblError::StoppedElsewhere { state: BoardState::Idle.word() })
    }

    /// Compares the steps since the last look with the time since. Steps that are missing may have been made
    /// by a motor whose counter jumped back.
    fn keep_pace(&mut self, now: Duration) {
        let (since, made) = self.under_way;
        let passed = now - since;
        let missing = self.task.steps_s * passed.as_secs_f64() - (self.made - made) as f64;
        let usual = self.task.steps_s * LATENCY.as_secs_f64() + 2.0;
        if missing.abs() > usual {
            self.behind = (self.behind + missing).max(0.0);
        }
        if missing.abs() > usual || passed > PACE {
            self.under_way = (now, self.made);
        }
    }

    /// Checks that the board still does its work, whatever it says.
    pub(super) fn watch(&mut self) -> Result<(), GrblError> {
        let now = self.board.now();
        if let Some((line, since)) = &self.awaited
            && now - *since > OK_LIMIT
        {
            return Err(GrblError::NoOk { line: line.clone(), waited_s: (now - *since).as_secs_f64() });
        }
        let still = now.saturating_sub(self.moved);
        if self.made < self.sent && still > self.task.patience() {
            return Err(GrblError::Stalled { waited_s: still.as_secs_f64() });
        }
        // A motor that pauses for the next jog is not late.
        if self.made == self.sent && self.sent < self.task.steps {
            return Ok(());
        }
        let taken_s = now.saturating_sub(self.begun.unwrap_or(now)).as_secs_f64();
        let needs_s = self.task.needs_s();
        if taken_s > LATE * needs_s + LATE_S {
            return Err(GrblError::Late { taken_s, needs_s });
        }
        Ok(())
    }
}
