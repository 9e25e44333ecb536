//! The link to a board: requests out, answers in.

use std::time::Duration;

use pump_link::frame::{AnswerHeader, Deframer, FrameError, body};
use pump_link::message::{Answer, Refusal, Request};
use pump_link::sender::Window;

use super::error::NodeError;
use crate::drives::StopRequest;
use crate::drives::wire::Wire;

/// Number of requests that are under way at most.
const WINDOW: usize = 8;

/// Longest wait for an answer that is not there yet, before the link looks at its times.
const LOOK: Duration = Duration::from_millis(5);

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

/// Link to a board.
#[derive(Debug)]
pub(super) struct Link {
    wire: Box<dyn Wire>,
    window: Window<WINDOW>,
    deframer: Deframer,
    /// Requests under way.
    asked: Vec<(u16, Subject)>,
    /// Number of bytes that came.
    pub(super) bytes: usize,
    /// Version of frames that came, if it is another.
    pub(super) other_version: Option<u8>,
    /// Time of the last answer.
    heard_at: Duration,
    stop: StopRequest,
    /// True while a gate hears the user in place of the link.
    pub(super) is_deaf: bool,
}

impl Link {
    /// Makes the link over `wire`, without a session.
    pub(super) fn new(wire: Box<dyn Wire>, stop: StopRequest) -> Self {
        Self {
            wire,
            window: Window::new(0),
            deframer: Deframer::new(),
            asked: Vec::new(),
            bytes: 0,
            other_version: None,
            heard_at: Duration::ZERO,
            stop,
            is_deaf: false,
        }
    }

    /// Begins with no request under way, in this session.
    pub(super) fn begin(&mut self, session: u64) {
        self.window = Window::new(session);
        self.asked.clear();
        (self.bytes, self.other_version) = (0, None);
        self.heard_at = self.wire.now();
    }

    /// Returns the session of this side.
    pub(super) fn session(&self) -> u64 {
        self.window.session()
    }

    /// Returns the time of the wire.
    pub(super) fn now(&mut self) -> Duration {
        self.wire.now()
    }

    /// Returns the error of a board that was last heard some time ago.
    pub(super) fn quiet(&mut self) -> NodeError {
        let waited_s = self.wire.now().saturating_sub(self.heard_at).as_secs_f64();
        NodeError::Quiet { waited_s }
    }

    /// Lets `time` pass.
    pub(super) fn sleep(&mut self, time: Duration) {
        self.wire.sleep(time);
    }

    /// Refuses to go on if the user asked to stop.
    pub(super) fn heed(&self) -> Result<(), NodeError> {
        if !self.is_deaf && self.stop.is_made() { Err(NodeError::Interrupted) } else { Ok(()) }
    }

    /// Returns the number of requests under way that have this subject.
    pub(super) fn under_way(&self, subject: Subject) -> usize {
        self.asked.iter().filter(|(_, asked)| *asked == subject).count()
    }

    /// Takes a request, which is sent by the next turn.
    pub(super) fn request(&mut self, request: &Request<'_>, subject: Subject) -> Result<(), NodeError> {
        let lane = (subject == Subject::Segments).then_some(0);
        let number = self.window.request(request, lane)?;
        self.asked.push((number, subject));
        Ok(())
    }

    /// Forgets the requests under way.
    pub(super) fn clear(&mut self) {
        self.window.clear();
        self.asked.clear();
    }

    /// Sends what is due, and takes in answers for as long as `wait` at most. Returns at the first answers.
    ///
    /// The link is lost only after all input was read.
    pub(super) fn turn(&mut self, wait: Duration, replies: &mut Vec<Reply>) -> Result<(), NodeError> {
        let until = self.wire.now() + wait;
        loop {
            self.send()?;
            let left = until.saturating_sub(self.wire.now());
            self.take(left.min(LOOK), replies)?;
            while self.take(Duration::ZERO, replies)? {}
            let now = self.wire.now();
            if self.window.expire(nanos(now)).is_err() {
                return Err(self.quiet());
            }
            if !replies.is_empty() || now >= until {
                return self.send();
            }
        }
    }

    /// Asks one request at rest, and waits for its answer.
    pub(super) fn ask(&mut self, request: &Request<'_>) -> Result<Reply, NodeError> {
        self.request(request, Subject::Single)?;
        let mut replies = Vec::new();
        loop {
            self.heed()?;
            self.turn(Duration::from_millis(20), &mut replies)?;
            if let Some(reply) = replies.drain(..).find(|reply| reply.subject == Subject::Single) {
                return Ok(reply);
            }
        }
    }

    /// Lets time pass, and takes in late answers.
    pub(super) fn pass(&mut self, time: Duration) -> Result<(), NodeError> {
        let until = self.wire.now() + time;
        let mut late = Vec::new();
        while self.wire.now() < until {
            let left = until.saturating_sub(self.wire.now());
            self.take(left.min(LOOK), &mut late)?;
        }
        Ok(())
    }

    fn send(&mut self) -> Result<(), NodeError> {
        loop {
            let now = nanos(self.wire.now());
            let Some(frame) = self.window.next_to_send(now) else { return Ok(()) };
            self.wire.write(frame.bytes()).map_err(NodeError::Gone)?;
        }
    }

    /// Reads bytes that come within `wait`. Returns true if there were any.
    fn take(&mut self, wait: Duration, replies: &mut Vec<Reply>) -> Result<bool, NodeError> {
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
                Ok((header, answer)) => replies.extend(self.on_answer(header, answer)),
                Err(FrameError::Version { version }) => self.other_version = Some(version),
                Err(_) => {}
            }
        }
        Ok(count > 0)
    }

    fn on_answer(&mut self, header: AnswerHeader, answer: Answer) -> Option<Reply> {
        self.heard_at = self.wire.now();
        if let Answer::Refused(Refusal::Gap { .. }) = answer {
            self.window.gap(header.number);
            return None;
        }
        self.window.answered(header.number)?;
        let place = self.asked.iter().position(|(number, _)| *number == header.number)?;
        let (_, subject) = self.asked.swap_remove(place);
        Some(Reply { subject, session: header.session, received_at: header.received_at, answer })
    }
}

fn nanos(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
