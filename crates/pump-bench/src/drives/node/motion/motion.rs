//! A motion of one axis by the board: moves from rest to rest until the plan is made, or ends before.
//!
//! The thread that streams gives each motion its turn. A turn never waits longer than it is told to, so several
//! motions of one board take turns.

use std::time::Duration;

use pump_ctl::plan::PlannedMotion;
use pump_link::message::{Answer, AxisState, AxisStatus, End, MoveOrder, PROMPT_PACKED, Refusal, Request};

use super::move_feed::MoveFeed;
use super::outcome::{Fault, Made};
use super::search::Search;
use super::steps::Steps;
use super::task::Task;
use crate::drives::node::board::Board;
use crate::drives::node::connect;
use crate::drives::node::error::NodeError;
use crate::drives::node::line::{Reply, Subject};
use crate::drives::sent_lead::SentLead;
use crate::drives::stepped::Lead;
use crate::drives::{BeginPlace, CommonBeginError};

/// Time between two questions for the state of the axis.
const STATUS: Duration = Duration::from_millis(20);

/// Longest wait for the end of a stop.
const STOP_LIMIT: Duration = Duration::from_secs(15);

/// Most frames of segments of an axis under way.
const MOST_FRAMES: usize = 6;

/// Parts of a second that frames under way may take on the line: 1/40 s, half the time after which they are sent
/// again.
const UNDER_WAY: u32 = 40;

/// Motion by the board.
pub(in crate::drives::node) struct Motion<'a> {
    pub(in crate::drives::node) board: &'a mut Board,
    plan: PlannedMotion<'a>,
    task: Task,
    free: &'a Lead,
    pub(super) lead: &'a SentLead<'a>,
    /// Count of the board before the motion.
    start: i64,
    seeks: bool,
    /// Last step that may be sent now.
    limit: u64,
    /// Last step that was sent when there was leave for no more.
    withheld_at: Option<u64>,
    /// Steps made, as the board told last.
    made: u64,
    /// Step at which the index sensor became active.
    index_at: Option<u64>,
    /// Tick at which the board was last heard.
    heard_at: u64,
    /// Time of the last question for the state.
    status_at: Duration,
    /// Move under way. There is none while the motor rests for want of leave.
    pub(super) feed: Option<MoveFeed<'a>>,
    /// True while the first move begins only with those of other axes.
    pub(super) waits_for_others: bool,
    /// Place of the first move among those of other threads, until it has begun.
    pub(super) place: Option<BeginPlace>,
    /// Search for a board that has fallen silent.
    search: Option<Search>,
    /// Error for which the move is stopped.
    failed: Option<NodeError>,
}

impl<'a> Motion<'a> {
    /// Makes a motion of an axis that stands at `start`. A motion that `seeks` ends at the index mark. `free` has leave
    /// for all steps.
    pub(in crate::drives::node) fn new(
        board: &'a mut Board,
        plan: PlannedMotion<'a>,
        task: Task,
        (lead, free): (&'a SentLead<'a>, &'a Lead),
        start: i64,
        seeks: bool,
    ) -> Self {
        Self {
            board,
            plan,
            task,
            free,
            lead,
            start,
            seeks,
            limit: 0,
            withheld_at: None,
            made: 0,
            index_at: None,
            heard_at: 0,
            status_at: Duration::ZERO,
            feed: None,
            waits_for_others: false,
            place: None,
            search: None,
            failed: None,
        }
    }

    /// Goes on for as long as `wait` at most. Returns the steps made once the motion has ended.
    pub(in crate::drives::node) fn turn(&mut self, wait: Duration) -> Option<Result<Made, Fault>> {
        let Some(mut feed) = self.feed.take().or_else(|| self.next_move()) else {
            if let Some(error) = self.failed.take() {
                return Some(Err(self.exactly(error)));
            }
            if self.made >= self.plan.steps().unsigned_abs() || self.lead.stops() {
                return Some(Ok(Made { steps: self.made, index_at: self.index_at }));
            }
            if self.is_too_late() {
                return Some(Err(self.exactly(NodeError::FlowPaused)));
            }
            return self.board.link.pass(wait).err().map(|error| Err(self.exactly(error)));
        };
        let turned = match &mut self.search {
            Some(_) => self.seek_board(&mut feed, wait),
            None => self.stream(&mut feed, wait),
        };
        let ended = match (turned, feed.state) {
            (Err(error), _) => self.fail(error, &mut feed),
            (Ok(()), Some(AxisState::Ended(end))) => return self.end_move(end),
            (Ok(()), _) => None,
        };
        self.feed = Some(feed);
        ended.map(Err)
    }

    /// Prepares the next move from rest, if there is leave for one.
    fn next_move(&mut self) -> Option<MoveFeed<'a>> {
        let all = self.plan.steps().unsigned_abs();
        if self.made >= all || self.lead.stops() || self.failed.is_some() || self.is_too_late() {
            return None;
        }
        self.limit = self.lead.sendable(self.limit.max(self.made));
        if self.limit <= self.made {
            return None;
        }
        let board = &mut *self.board;
        board.move_number += 1;
        let direction = i64::from(self.plan.direction().sign());
        let order = MoveOrder {
            from: self.start + direction * self.made as i64,
            last: self.start + self.plan.steps(),
            shortest_interval: self.task.shortest_interval,
        };
        let steps = Steps::new(self.plan, board.tick_rate, self.free, self.made);
        let hz = board.tick_rate.hz();
        Some(MoveFeed::new(board.move_number, order, steps, self.made, self.task.brake_steps, hz))
    }

    /// Returns true for a flow over time that came to rest on its way: its times have passed.
    fn is_too_late(&self) -> bool {
        self.made > 0 && matches!(self.plan, PlannedMotion::Flow(_))
    }

    /// Ends a move from rest to rest. Returns the end of the motion if it is one.
    fn end_move(&mut self, end: End) -> Option<Result<Made, Fault>> {
        let has_cause = matches!(end, End::DeadMan | End::Late | End::Driver | End::Estop);
        match self.failed.take() {
            // The axes that were to begin together did not, and the board says why this one could not.
            Some(NodeError::Common(_)) if has_cause => {}
            Some(error) => return Some(Err(self.exactly(error))),
            None => {}
        }
        match end {
            End::Complete => None,
            End::Starved => {
                let told = self.confirm().and_then(|()| self.has_starved());
                told.err().map(|error| Err(self.exactly(error)))
            }
            End::Stopped if self.lead.stops() => None,
            end => Some(Err(self.exactly(self.error_of(end)))),
        }
    }

    /// Sends what is due, and takes in answers.
    fn stream(&mut self, feed: &mut MoveFeed<'a>, wait: Duration) -> Result<(), NodeError> {
        if self.seeks && self.index_at.is_some() {
            self.lead.stop();
        }
        if self.failed.is_some() || self.lead.stops() {
            self.stop(feed)?;
        } else {
            self.send(feed)?;
        }
        self.exchange(feed, wait)
    }

    /// Sends what the move needs next.
    fn send(&mut self, feed: &mut MoveFeed<'a>) -> Result<(), NodeError> {
        let axis = self.board.axis;
        let link = &mut self.board.link;
        if !feed.is_prepared {
            if link.under_way(Subject::Single) == 0 {
                let request = Request::Prepare { axis, move_number: feed.number, order: feed.order };
                link.request(&request, Subject::Single)?;
            }
            return Ok(());
        }
        if feed.takes() {
            self.limit = self.lead.sendable(self.limit);
            feed.push(self.limit)?;
            if self.lead.is_withheld(feed.pushed) {
                self.withheld_at = Some(feed.pushed);
            }
            let bytes_s = self.board.baud / 10;
            let most = (bytes_s / UNDER_WAY / self.task.sharers) as usize;
            let frames = (most / PROMPT_PACKED).clamp(1, MOST_FRAMES);
            let mut packed = [0; PROMPT_PACKED];
            while link.under_way(Subject::Segments) < frames {
                let room = packed.get_mut(..most.clamp(32, PROMPT_PACKED)).unwrap_or_default();
                let Some(chunk) = feed.stream.chunk(room) else { break };
                feed.bracket.sent(chunk.end);
                let packed = packed.get(..chunk.bytes).unwrap_or_default();
                let (move_number, first) = (feed.number, chunk.first);
                link.request(&Request::Segments { axis, move_number, first, packed }, Subject::Segments)?;
            }
        }
        if !self.waits_for_others && !feed.is_begun && self.is_loaded(feed) {
            let (at, moves) = (feed.begin_at(self.heard_at), self.board.moves());
            let link = &mut self.board.link;
            if link.under_way(Subject::Begin) == 0 {
                feed.may_move = true;
                link.request(&Request::Begin { at, moves }, Subject::Begin)?;
            }
        }
        Ok(())
    }

    fn is_loaded(&self, feed: &MoveFeed<'_>) -> bool {
        feed.is_loaded(self.limit, self.board.identity.queue)
    }

    /// Returns the first tick at which the move can begin, if the board holds enough of it.
    pub(in crate::drives::node) fn ready_at(&self) -> Option<u64> {
        let feed = self.feed.as_ref().filter(|feed| self.search.is_none() && self.is_loaded(feed))?;
        Some(feed.begin_at(self.heard_at))
    }

    /// Returns true once the motion is to end with an error.
    pub(super) fn is_failing(&self) -> bool {
        self.failed.is_some()
    }

    /// Has the motion end with this error.
    pub(super) fn refuse(&mut self, error: NodeError) {
        self.failed.get_or_insert(error);
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
    fn exchange(&mut self, feed: &mut MoveFeed<'_>, wait: Duration) -> Result<(), NodeError> {
        let link = &mut self.board.link;
        let now = link.now();
        if now.saturating_sub(self.status_at) >= STATUS && link.under_way(Subject::Status) == 0 {
            self.status_at = now;
            link.request(&Request::Status { axis: self.board.axis }, Subject::Status)?;
        }
        let mut replies = Vec::new();
        let turned = link.turn(wait, &mut replies);
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
            (Answer::Refused(Refusal::Begin { .. }), _) if feed.begin_tick.is_some() => {
                return Err(CommonBeginError::Missed.into());
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
        self.lead.note_made(self.made);
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

    /// Seeks a board that has fallen silent, in the same session. A question stays under way until it is answered,
    /// however late: it is sent again, and is not replaced by a new one.
    fn seek_board(&mut self, feed: &mut MoveFeed<'a>, wait: Duration) -> Result<(), NodeError> {
        let Some(search) = &mut self.search else { return Ok(()) };
        let link = &mut self.board.link;
        let (now, heard_at) = (link.now(), link.heard_at());
        let stops = self.lead.stops();
        if search.is_over(now, heard_at, stops) {
            return Err(link.quiet());
        }
        if search.knocks(now, stops) {
            link.renew();
            if link.under_way(Subject::Status) == 0 {
                link.request(&Request::Status { axis: self.board.axis }, Subject::Status)?;
            }
            if stops && link.under_way(Subject::Stop) == 0 {
                let moves = self.board.moves();
                self.board.link.request(&Request::Stop { moves }, Subject::Stop)?;
            }
        }
        let mut replies = Vec::new();
        match self.board.link.turn(wait, &mut replies) {
            Ok(()) | Err(NodeError::Quiet { .. }) => {}
            Err(error) => return Err(error),
        }
        if replies.is_empty() {
            return Ok(());
        }
        self.search = None;
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

    /// Treats an error. Returns the fault if the motion ends with it. Otherwise a board that can still be heard is
    /// sought or stopped first.
    fn fail(&mut self, error: NodeError, feed: &mut MoveFeed<'a>) -> Option<Fault> {
        let now = self.board.link.now();
        if matches!(error, NodeError::Quiet { .. }) && self.search.is_none() {
            // The search asks for the state alone. What the board has of the rest, its state tells.
            self.board.link.clear();
            self.search = Some(Search::new(now, self.board.patience));
            return None;
        }
        let error = match self.failed.take() {
            Some(first) => first,
            None if error.ends_link() => error,
            None => {
                self.board.link.clear();
                feed.is_stopped = false;
                self.failed = Some(error);
                return None;
            }
        };
        let is_at_rest = !feed.may_move && self.place.take().is_none_or(|mut place| place.gives_up());
        if is_at_rest {
            return Some(self.exactly(error));
        }
        let direction = i64::from(self.plan.direction().sign());
        let (one, other) = feed.bracket.range();
        let [one, other] = [one, other].map(|position| (position - self.start) * direction);
        Some(Fault { error, least: one.min(other), most: one.max(other) })
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

    /// Refuses to go on if the board ran out of steps that had leave: the host was not in time. A motor that waits for
    /// leave goes on once there is some.
    fn has_starved(&self) -> Result<(), NodeError> {
        let waited = self.withheld_at.is_some_and(|at| self.made <= at.saturating_add(self.task.brake_steps));
        if waited || self.is_too_late() { Ok(()) } else { Err(NodeError::HeldUp) }
    }

    /// Confirms the faults that the board has counted.
    fn confirm(&mut self) -> Result<(), NodeError> {
        let (status, _) = self.board.status()?;
        connect::confirm(self.board, &status)
    }
}
