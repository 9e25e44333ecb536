//! The line to a board: frames on a wire, requests under way, and the answers to them.

use std::time::Duration;

use pump_link::frame::{AnswerHeader, Deframer, FrameError, body};
use pump_link::message::{AXES, Answer, Refusal, Request};
use pump_link::sender::Window;

use super::board_record::BoardHold;
use super::error::NodeError;
use crate::drives::wire::Wire;

/// Number of requests that are under way at most: 8 for each axis.
const WINDOW: usize = 8 * AXES;

/// Subject of a request, by which its answer is told from others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Subject {
    /// Any request at rest, one at a time.
    Single,
    /// State of the axis.
    Status,
    /// Segments of the move.
    Segments,
    /// Begin of the move.
    Begin,
    /// Stop of the move.
    Stop,
}

/// Answer of the board.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reply {
    pub(super) subject: Subject,
    /// Session number that the board holds.
    pub(super) session: u64,
    /// Tick of the board's timer at which it took the request.
    pub(super) received_at: u64,
    pub(super) answer: Answer,
}

/// Request under way.
#[derive(Debug, Clone, Copy)]
struct Asked {
    number: u16,
    lane: u8,
    subject: Subject,
}

/// Line to a board, which the links of its axes share.
#[derive(Debug)]
pub(super) struct Line {
    pub(super) wire: Box<dyn Wire>,
    window: Window<WINDOW>,
    deframer: Deframer,
    asked: Vec<Asked>,
    /// Answers that their links have not collected, each with its lane.
    inbox: Vec<(u8, Reply)>,
    /// Number of bytes that came.
    pub(super) bytes: usize,
    /// Version of frames that came, if it is another.
    pub(super) other_version: Option<u8>,
    /// Time of the last answer.
    heard_at: Duration,
    /// Session that a link of this line gave the board last. It is 0 before the first.
    pub(super) given: u64,
    /// Board's record, which no other process writes while the line lives.
    pub(super) hold: Option<BoardHold>,
}

impl Line {
    /// Makes the line over `wire`, without a session.
    pub(super) fn new(wire: Box<dyn Wire>) -> Self {
        Self {
            wire,
            window: Window::new(0),
            deframer: Deframer::new(),
            asked: Vec::new(),
            inbox: Vec::new(),
            bytes: 0,
            other_version: None,
            heard_at: Duration::ZERO,
            given: 0,
            hold: None,
        }
    }

    /// Begins with no request under way, in this session.
    pub(super) fn begin(&mut self, session: u64) {
        self.window = Window::new(session);
        self.asked.clear();
        self.inbox.clear();
        (self.bytes, self.other_version) = (0, None);
        self.heard_at = self.wire.now();
    }

    /// Returns the session of this side.
    pub(super) fn session(&self) -> u64 {
        self.window.session()
    }

    /// Returns the error of a board that was last heard some time ago.
    pub(super) fn quiet(&mut self) -> NodeError {
        let waited_s = self.wire.now().saturating_sub(self.heard_at).as_secs_f64();
        NodeError::Quiet { waited_s }
    }

    /// Returns the number of requests of a lane under way that have this subject.
    pub(super) fn under_way(&self, lane: u8, subject: Subject) -> usize {
        self.asked.iter().filter(|asked| (asked.lane, asked.subject) == (lane, subject)).count()
    }

    /// Takes a request of a lane. The segments of one lane arrive in order.
    pub(super) fn request(
        &mut self,
        lane: u8,
        request: &Request<'_>,
        subject: Subject,
    ) -> Result<(), NodeError> {
        let number = self.window.request(request, (subject == Subject::Segments).then_some(lane))?;
        self.asked.push(Asked { number, lane, subject });
        Ok(())
    }

    /// Forgets the requests of a lane.
    pub(super) fn forget(&mut self, lane: u8) {
        let window = &mut self.window;
        self.asked.retain(|asked| {
            let stays = asked.lane != lane;
            if !stays {
                window.forget(asked.number);
            }
            stays
        });
        self.drop_answers(lane);
    }

    /// Drops the answers of a lane.
    pub(super) fn drop_answers(&mut self, lane: u8) {
        self.inbox.retain(|(to, _)| *to != lane);
    }

    /// Returns true if no link has answers to collect.
    pub(super) fn inbox_is_empty(&self) -> bool {
        self.inbox.is_empty()
    }

    /// Moves the answers of a lane to `replies`.
    pub(super) fn collect(&mut self, lane: u8, replies: &mut Vec<Reply>) {
        self.inbox.retain(|(to, reply)| {
            if *to == lane {
                replies.push(*reply);
            }
            *to != lane
        });
    }

    /// Sends what is due.
    pub(super) fn send(&mut self) -> Result<(), NodeError> {
        loop {
            let now = nanos(self.wire.now());
            let Some(frame) = self.window.next_to_send(now) else { return Ok(()) };
            self.wire.write(frame.bytes()).map_err(NodeError::Gone)?;
        }
    }

    /// Has overdue requests sent again, or finds the link lost. Call it after all input was read.
    pub(super) fn expire(&mut self) -> Result<(), NodeError> {
        let now = self.wire.now();
        if self.window.expire(nanos(now)).is_err() { Err(self.quiet()) } else { Ok(()) }
    }

    /// Has the requests under way sent again after a lost link.
    pub(super) fn renew(&mut self) {
        self.window.renew();
    }

    /// Reads bytes that come within `wait`. Returns true if there were any.
    pub(super) fn take(&mut self, wait: Duration) -> Result<bool, NodeError> {
        let mut buffer = [0; 512];
        let count = self.wire.read(&mut buffer, wait).map_err(NodeError::Gone)?;
        self.bytes = self.bytes.saturating_add(count);
        for byte in buffer.iter().take(count) {
            let read = match self.deframer.push(*byte) {
                Some(Ok(payload)) => AnswerHeader::split(payload)
                    .and_then(|(header, rest)| body::<Answer>(rest).map(|answer| (header, answer))),
                _ => continue,
            };
            match read {
                Ok((header, answer)) => self.on_answer(header, answer),
                Err(FrameError::Version { version }) => self.other_version = Some(version),
                Err(_) => {}
            }
        }
        Ok(count > 0)
    }

    fn on_answer(&mut self, header: AnswerHeader, answer: Answer) {
        self.heard_at = self.wire.now();
        if let Answer::Refused(Refusal::Gap { .. }) = answer {
            self.window.gap(header.number);
            return;
        }
        if self.window.answered(header.number).is_none() {
            return;
        }
        let Some(place) = self.asked.iter().position(|asked| asked.number == header.number) else { return };
        let Asked { lane, subject, .. } = self.asked.swap_remove(place);
        let (session, received_at) = (header.session, header.received_at);
        self.inbox.push((lane, Reply { subject, session, received_at, answer }));
    }
}

fn nanos(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
