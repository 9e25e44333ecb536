//! A motion by the board: moves from rest to rest until the plan is made, or ends before.

use std::time::Duration;

use pump_ctl::plan::Plan;
use pump_link::message::{Answer, AxisState, AxisStatus, End, MAX_PACKED, MoveOrder, Refusal, Request};

use super::board::Board;
use super::connect;
use super::error::NodeError;
use super::lead::SentLead;
use super::link::{Reply, Subject};
use super::move_feed::MoveFeed;
use super::outcome::Fault;
use super::steps::Steps;
use super::task::Task;
use crate::drives::Gate;
use crate::drives::stepped::Lead;

/// Longest time between two questions to the gate.
const LOOK: Duration = Duration::from_millis(5);

/// Time between two questions for the state of the axis.
const STATUS: Duration = Duration::from_millis(20);

/// Longest time for which a board is sought that has fallen silent in motion.
const SEARCH_LIMIT: Duration = Duration::from_secs(3);

/// Time between two questions to a silent board.
const KNOCK: Duration = Duration::from_millis(200);

/// Longest wait for the end of a stop.
const STOP_LIMIT: Duration = Duration::from_secs(15);

/// Most frames of segments under way.
const MOST_FRAMES: usize = 4;

/// Parts of a second that frames under way may take on the line: 1/40 s, half the time after which they are sent
/// again.
const UNDER_WAY: u32 = 40;

/// Motion by the board.
pub(super) struct Motion<'a> {
    board: &'a mut Board,
    plan: &'a Plan,
    task: Task,
    /// Count of the board before the motion.
    start: i64,
    seeks: bool,
    lead: SentLead,
    /// Steps made, as the board told last.
    made: u64,
    /// Step at which the index sensor became active.
    index_at: Option<u64>,
    /// Tick at which the board was last heard.
    heard_at: u64,
    /// Time of the last question for the state.
    status_at: Duration,
}

impl<'a> Motion<'a> {
    /// Makes a motion of an axis that stands at `start`. A motion that `seeks` ends at the index mark.
    pub(super) fn new(board: &'a mut Board, plan: &'a Plan, task: Task, start: i64, seeks: bool) -> Self {
        let lead = SentLead::new(plan.steps().unsigned_abs(), task.brake_steps);
        let (heard_at, status_at) = (0, Duration::ZERO);
        Self { board, plan, task, start, seeks, lead, made: 0, index_at: None, heard_at, status_at }
    }

    /// Makes the steps of the plan. Returns the number of steps made, with the step at which the index was found.
    pub(super) fn make(&mut self, gate: &mut Gate<'_>) -> Result<(u64, Option<u64>), Fault> {
        let all = self.plan.steps().unsigned_abs();
        while self.made < all && !self.lead.stops {
            self.lead.ask(self.plan, self.made, gate);
            if self.lead.stops {
                break;
            }
            if self.lead.reach() <= self.made {
                self.board.link.pass(LOOK).map_err(|error| self.exactly(error))?;
                continue;
            }
            match self.one_move(gate)? {
                End::Complete => {}
                End::Starved => self.confirm().map_err(|error| self.exactly(error))?,
                End::Stopped if self.lead.stops => {}
                end => return Err(self.exactly(self.error_of(end))),
            }
        }
        Ok((self.made, self.index_at))
    }

    /// Makes a move from rest, until the board stands. Returns how it ended.
    fn one_move(&mut self, gate: &mut Gate<'_>) -> Result<End, Fault> {
        let free = Lead::free();
        let board = &mut *self.board;
        board.move_number += 1;
        let direction = i64::from(self.plan.direction().sign());
        let order = MoveOrder {
            from: self.start + direction * self.made as i64,
            last: self.start + self.plan.steps(),
            shortest_interval: self.task.shortest_interval,
        };
        let steps = Steps::new(self.plan, board.tick_rate, &free, self.made);
        let hz = board.tick_rate.hz();
        let mut feed = MoveFeed::new(board.move_number, order, steps, self.made, self.task.brake_steps, hz);
        loop {
            let ended = match self.turn(&mut feed, gate) {
                Err(NodeError::Quiet { .. }) => self.find_again(&mut feed),
                turned => turned,
            };
            match (ended, feed.state) {
                (Ok(()), Some(AxisState::Ended(end))) => return Ok(end),
                (Ok(()), _) => {}
                (Err(error), _) => return Err(self.recover(error, &mut feed)),
            }
        }
    }

    /// Asks the gate, sends what is due, and takes in answers.
    fn turn(&mut self, feed: &mut MoveFeed<'_>, gate: &mut Gate<'_>) -> Result<(), NodeError> {
        if !self.lead.stops {
            self.lead.ask(self.plan, self.made, gate);
        }
        self.lead.stops |= self.seeks && self.index_at.is_some();
        if self.lead.stops {
            self.stop(feed)?;
        } else {
            self.send(feed)?;
        }
        self.exchange(feed)
    }

    /// Sends what the move needs next.
    fn send(&mut self, feed: &mut MoveFeed<'_>) -> Result<(), NodeError> {
        let (axis, reach) = (self.board.axis, self.lead.reach());
        let (queue, moves) = (self.board.identity.queue, self.board.moves());
        let link = &mut self.board.link;
        if !feed.is_prepared {
            if link.under_way(Subject::Single) == 0 {
                let request = Request::Prepare { axis, move_number: feed.number, order: feed.order };
                link.request(&request, Subject::Single)?;
            }
            return Ok(());
        }
        if feed.takes() {
            feed.push(reach)?;
            let bytes_s = self.board.baud / 10;
            let most = (bytes_s / UNDER_WAY) as usize;
            let frames = (most / MAX_PACKED).clamp(1, MOST_FRAMES);
            let mut packed = [0; MAX_PACKED];
            while link.under_way(Subject::Segments) < frames {
                let room = packed.get_mut(..most.clamp(32, MAX_PACKED)).unwrap_or_default();
                let Some(chunk) = feed.stream.chunk(room) else { break };
                feed.bracket.sent(chunk.end);
                let packed = packed.get(..chunk.bytes).unwrap_or_default();
                let (move_number, first) = (feed.number, chunk.first);
                link.request(&Request::Segments { axis, move_number, first, packed }, Subject::Segments)?;
            }
        }
        if !feed.is_begun && link.under_way(Subject::Begin) == 0 && feed.is_loaded(reach, queue) {
            link.request(&Request::Begin { at: feed.begin_at(self.heard_at), moves }, Subject::Begin)?;
        }
        Ok(())
    }

    /// Tells the board to stop, once.
    fn stop(&mut self, feed: &mut MoveFeed<'_>) -> Result<(), NodeError> {
        let moves = self.board.moves();
        let link = &mut self.board.link;
        let now = link.now();
        let asked_at = *feed.stop_asked_at.get_or_insert(now);
        let waited = now.saturating_sub(asked_at);
        if waited > STOP_LIMIT {
            return Err(NodeError::Unstoppable { waited_s: waited.as_secs_f64() });
        }
        if !feed.is_stopped && link.under_way(Subject::Stop) == 0 {
            link.request(&Request::Stop { moves }, Subject::Stop)?;
        }
        Ok(())
    }

    /// Asks for the state of the axis when it is time, and takes in answers.
    fn exchange(&mut self, feed: &mut MoveFeed<'_>) -> Result<(), NodeError> {
        let link = &mut self.board.link;
        let now = link.now();
        if now.saturating_sub(self.status_at) >= STATUS && link.under_way(Subject::Status) == 0 {
            self.status_at = now;
            link.request(&Request::Status { axis: self.board.axis }, Subject::Status)?;
        }
        let mut replies = Vec::new();
        let turned = link.turn(LOOK, &mut replies);
        replies.iter().try_for_each(|reply| self.hear(feed, reply))?;
        turned
    }

    /// Takes in an answer.
    fn hear(&mut self, feed: &mut MoveFeed<'_>, reply: &Reply) -> Result<(), NodeError> {
        self.board.holds(reply)?;
        self.heard_at = self.heard_at.max(reply.received_at);
        match (reply.answer, reply.subject) {
            (Answer::Status(status), _) => self.note(feed, &status)?,
            (Answer::Accepted { next, room }, _) => {
                feed.is_prepared = true;
                feed.stream.accepted(next, room)?;
            }
            (Answer::Begun, _) => feed.is_begun = true,
            (Answer::Stopped { .. }, _) => feed.is_stopped = true,
            // The move has ended, or decelerates. Its state tells how.
            (Answer::Refused(Refusal::NoSuchMove { .. }), Subject::Segments | Subject::Begin) => {
                feed.is_closed = true;
            }
            (Answer::Refused(Refusal::Begin { earliest }), _) => feed.earliest = earliest,
            (Answer::Refused(Refusal::Position { position }), _) => {
                return Err(NodeError::Count { counted: position, expected: feed.order.from });
            }
            (Answer::Refused(refusal), _) => return Err(NodeError::of(refusal)),
            _ => {}
        }
        Ok(())
    }

    /// Notes the state of the axis.
    fn note(&mut self, feed: &mut MoveFeed<'_>, status: &AxisStatus) -> Result<(), NodeError> {
        let direction = i64::from(self.plan.direction().sign());
        let way = |position: i64| u64::try_from((position - self.start) * direction).unwrap_or(0);
        feed.bracket.reported(status.position);
        self.made = self.made.max(way(status.position));
        if status.move_number > feed.number {
            return Err(NodeError::StoppedElsewhere);
        }
        if status.move_number == feed.number {
            feed.is_prepared = true;
            feed.stream.accepted(status.next_segment, status.room)?;
            feed.state = Some(status.state);
            if self.seeks && self.index_at.is_none() {
                self.index_at = status.index_at.map(way);
            }
        }
        Ok(())
    }

    /// Seeks a board that has fallen silent. All that is under way is asked again, in the same session.
    fn find_again(&mut self, feed: &mut MoveFeed<'_>) -> Result<(), NodeError> {
        let began = self.board.link.now();
        let mut replies = Vec::new();
        while replies.is_empty() {
            let link = &mut self.board.link;
            link.clear();
            if link.now().saturating_sub(began) > SEARCH_LIMIT {
                return Err(link.quiet());
            }
            link.request(&Request::Status { axis: self.board.axis }, Subject::Status)?;
            match link.turn(KNOCK, &mut replies) {
                Ok(()) | Err(NodeError::Quiet { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        (feed.is_begun, feed.is_stopped) = (false, false);
        for reply in &replies {
            self.hear(feed, reply)?;
            if let Answer::Status(status) = reply.answer
                && status.move_number == feed.number
            {
                feed.is_begun = status.state != AxisState::Prepared;
                feed.stream.resume(status.next_segment, status.room)?;
            }
        }
        Ok(())
    }

    /// Stops a board that can still be heard. Returns the fault, with the steps made.
    fn recover(&mut self, error: NodeError, feed: &mut MoveFeed<'_>) -> Fault {
        if !error.ends_link() {
            self.board.link.clear();
            feed.is_stopped = false;
            loop {
                let turned = self.stop(feed).and_then(|()| self.exchange(feed));
                match (turned, feed.state) {
                    (Ok(()), Some(AxisState::Ended(_))) => return self.exactly(error),
                    (Ok(()), _) => {}
                    (Err(_), _) => break,
                }
            }
        }
        let direction = i64::from(self.plan.direction().sign());
        let (one, other) = feed.bracket.range();
        let [one, other] = [one, other].map(|position| (position - self.start) * direction);
        Fault { error, least: one.min(other), most: one.max(other) }
    }

    /// Returns the fault of a motor that stands, with the steps that the board counts.
    fn exactly(&self, error: NodeError) -> Fault {
        Fault { error, least: self.made as i64, most: self.made as i64 }
    }

    /// Returns the error of a move that ended so.
    fn error_of(&self, end: End) -> NodeError {
        match end {
            End::DeadMan => NodeError::DeadMan { dead_man_ms: self.board.dead_man_ms },
            End::Late => NodeError::Late,
            End::Driver => NodeError::Driver,
            End::Estop => NodeError::Estop,
            _ => NodeError::StoppedElsewhere,
        }
    }

    /// Confirms the faults that the board has counted.
    fn confirm(&mut self) -> Result<(), NodeError> {
        let (status, _) = self.board.status()?;
        connect::confirm(self.board, &status)
    }
}
