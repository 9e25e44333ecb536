//! The line to a board: frames on a wire, requests under way, and the answers to them.

use std::io;
use std::time::{Duration, Instant};

use pump_link::frame::{AnswerHeader, Deframer, FrameError, body};
use pump_link::message::{AXES, Answer, Identity, Refusal, Request};
use pump_link::sender::Window;

use super::board_record::BoardHold;
use super::error::NodeError;
use crate::drives::board_clock::{BoardClock, ClockBounds, Reading, SharedClock};
use crate::drives::wire::Wire;

/// Number of requests that are under way at most: 8 for each axis.
const WINDOW: usize = 8 * AXES;

/// Shortest time between two readings of the board's clock.
const READ: Duration = Duration::from_millis(10);

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
    /// Time by the steady clock before which the request was not sent. `None` while another link waits at the wire.
    not_before: Option<Duration>,
}

/// Axis of a line's board, while a link has it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lane {
    /// True while a link has the axis.
    pub(super) is_taken: bool,
    /// True once the board has the configuration of the axis.
    pub(super) is_met: bool,
    /// Dead-man time that the pump of the axis asks for, ms.
    pub(super) dead_man_ms: Option<u16>,
    /// Bytes a second that the motion of the axis needs at most.
    pub(super) needs_bytes_s: u32,
    /// Steps a second that the board counts for the motion of the axis.
    pub(super) needs_steps_s: u32,
}

/// Line to a board, which the links of its axes share.
#[derive(Debug)]
pub(super) struct Line {
    /// Wire, unless a link waits at it or it broke.
    wire: Option<Box<dyn Wire>>,
    /// Time of the wire, as it was read last.
    now: Duration,
    /// Cause for which nothing more is heard, once there is one.
    broken: Option<(io::ErrorKind, String)>,
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
    /// Number of times that the link was lost.
    pub(super) losses: u32,
    /// Session that a link of this line gave the board last. It is 0 before the first.
    pub(super) given: u64,
    /// Board at the other end, once it was met.
    pub(super) identity: Option<Identity>,
    /// Axes of the board.
    pub(super) lanes: [Lane; AXES],
    /// True if the board's clock is followed, for motions that begin together with those at other boards.
    pub(super) follows_clock: bool,
    /// Clock of the board, once it was read.
    clock: Option<SharedClock>,
    /// Times of its first and of its last reading.
    read_from: Duration,
    read_at: Duration,
    /// Number of threads that stream, and of those of them that wait for the board.
    pub(super) streaming: usize,
    pub(super) waiting: usize,
    /// True while one link waits at the wire for all.
    pub(super) is_led: bool,
    /// Board's record, which no other process writes while the line lives.
    pub(super) hold: Option<BoardHold>,
}

impl Line {
    /// Makes the line over `wire`, without a session.
    pub(super) fn new(wire: Box<dyn Wire>) -> Self {
        Self {
            wire: Some(wire),
            now: Duration::ZERO,
            broken: None,
            window: Window::new(0),
            deframer: Deframer::new(),
            asked: Vec::new(),
            inbox: Vec::new(),
            bytes: 0,
            other_version: None,
            heard_at: Duration::ZERO,
            losses: 0,
            given: 0,
            identity: None,
            lanes: [Lane::default(); AXES],
            follows_clock: false,
            clock: None,
            read_from: Duration::ZERO,
            read_at: Duration::ZERO,
            streaming: 0,
            waiting: 0,
            is_led: false,
            hold: None,
        }
    }

    /// Begins with no request under way, in this session. Every link has to meet the board anew.
    pub(super) fn begin(&mut self, session: u64) {
        self.window = Window::new(session);
        self.asked.clear();
        self.inbox.clear();
        (self.bytes, self.other_version) = (0, None);
        self.heard_at = self.now();
        self.lanes.iter_mut().for_each(|lane| lane.is_met = false);
    }

    /// Returns the time of the wire. While a link waits at the wire, it is the time at which that link began to wait.
    pub(super) fn now(&mut self) -> Duration {
        if let Some(wire) = &mut self.wire {
            self.now = self.now.max(wire.now());
        }
        self.now
    }

    /// Takes the wire away, to wait at it.
    pub(super) fn take_wire(&mut self) -> Option<Box<dyn Wire>> {
        self.wire.take()
    }

    /// Puts the wire back, unless it broke meanwhile.
    pub(super) fn put_wire(&mut self, wire: Box<dyn Wire>) {
        if self.broken.is_none() {
            self.wire = Some(wire);
        }
    }

    /// Returns the wire if no link waits at it.
    pub(super) fn wire(&mut self) -> Option<&mut Box<dyn Wire>> {
        self.wire.as_mut()
    }

    /// Notes that nothing more is heard, and closes the wire.
    pub(super) fn breaks(&mut self, error: &io::Error) {
        self.broken.get_or_insert((error.kind(), error.to_string()));
        self.wire = None;
    }

    /// Returns true once nothing more is heard.
    pub(super) fn is_broken(&self) -> bool {
        self.broken.is_some()
    }

    /// Refuses to go on over a line that broke.
    pub(super) fn check(&self) -> Result<(), NodeError> {
        match &self.broken {
            Some((kind, text)) => Err(NodeError::Gone(io::Error::new(*kind, text.clone()))),
            None => Ok(()),
        }
    }

    /// Returns the axis of a lane.
    pub(super) fn lane(&mut self, lane: u8) -> Option<&mut Lane> {
        self.lanes.get_mut(usize::from(lane))
    }

    /// Returns the other axes that links have.
    pub(super) fn others(&self, lane: u8) -> impl Iterator<Item = &Lane> {
        let others = self.lanes.iter().enumerate().filter(move |(n, _)| *n != usize::from(lane));
        others.map(|(_, other)| other).filter(|other| other.is_taken)
    }

    /// Returns the shortest dead-man time that the pumps of the board ask for.
    pub(super) fn dead_man_ms(&self) -> Option<u16> {
        self.lanes.iter().filter(|lane| lane.is_taken).filter_map(|lane| lane.dead_man_ms).min()
    }

    /// Returns the time of the board's last answer.
    pub(super) fn heard_at(&self) -> Duration {
        self.heard_at
    }

    /// Returns the session of this side.
    pub(super) fn session(&self) -> u64 {
        self.window.session()
    }

    /// Returns the error of a board that was last heard some time ago.
    pub(super) fn quiet(&mut self) -> NodeError {
        let waited_s = self.now().saturating_sub(self.heard_at).as_secs_f64();
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
        let not_before = self.wire.as_mut().map(|wire| wire.steady_now());
        self.asked.push(Asked { number, lane, subject, not_before });
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

    /// Returns true if a request of a lane is under way.
    pub(super) fn has_asked(&self, lane: u8) -> bool {
        self.asked.iter().any(|asked| asked.lane == lane)
    }

    /// Sends what is due, unless a link waits at the wire: that one does it.
    pub(super) fn send(&mut self) {
        let now = nanos(self.now());
        while let Some(wire) = &mut self.wire {
            let Some(frame) = self.window.next_to_send(now) else { return };
            if let Err(error) = wire.write(frame.bytes()) {
                self.breaks(&error);
            }
        }
    }

    /// Has overdue requests sent again, or notes that the link is lost. Call it after all input was read.
    pub(super) fn expire(&mut self) {
        let now = nanos(self.now());
        if self.window.expire(now).is_err() {
            self.losses = self.losses.wrapping_add(1);
        }
    }

    /// Has the requests under way sent again after a lost link.
    pub(super) fn renew(&mut self) {
        self.window.renew();
    }

    /// Takes in all bytes that have come.
    pub(super) fn drain(&mut self) {
        let mut buffer = [0; 512];
        while let Some(wire) = &mut self.wire {
            match wire.read(&mut buffer, Duration::ZERO) {
                Ok(0) => return,
                Ok(count) => self.take(buffer.get(..count).unwrap_or_default()),
                Err(error) => self.breaks(&error),
            }
        }
    }

    /// Takes in bytes of the board.
    pub(super) fn take(&mut self, bytes: &[u8]) {
        self.bytes = self.bytes.saturating_add(bytes.len());
        for byte in bytes {
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
    }

    fn on_answer(&mut self, header: AnswerHeader, answer: Answer) {
        self.heard_at = self.now();
        if let Answer::Refused(Refusal::Gap { .. }) = answer {
            self.window.gap(header.number);
            return;
        }
        if self.window.answered(header.number).is_none() {
            return;
        }
        let Some(place) = self.asked.iter().position(|asked| asked.number == header.number) else { return };
        let Asked { lane, subject, not_before, .. } = self.asked.swap_remove(place);
        let (session, received_at) = (header.session, header.received_at);
        if self.follows_clock {
            self.read_clock(not_before, received_at);
        }
        self.inbox.push((lane, Reply { subject, session, received_at, answer }));
    }

    /// Takes the tick at which the board took a request as a reading of its clock.
    fn read_clock(&mut self, not_before: Option<Duration>, ticks: u64) {
        let (Some(from), Some(identity), Some(wire)) = (not_before, &self.identity, &mut self.wire) else {
            return;
        };
        let reading = Reading { from, to: wire.steady_now(), ticks };
        if self.clock.is_some() && reading.to < self.read_at + READ {
            return;
        }
        self.read_at = reading.to;
        let low = Reading { from, to: reading.to, ticks: ticks as u32 };
        let is_followed =
            self.clock.as_ref().is_some_and(|clock| clock.take(low).is_ok_and(|whole| whole == ticks));
        if !is_followed {
            // The board has begun anew, or its clock was read too long ago.
            let clock = BoardClock::new(identity.tick_hz, ClockBounds::default(), reading);
            self.clock = clock.ok().map(SharedClock::new);
            self.read_from = reading.to;
        }
    }

    /// Returns the time over which the board's clock was read.
    pub(super) fn clock_span(&self) -> Duration {
        self.read_at.saturating_sub(self.read_from)
    }

    /// Returns true if the board's clock was read.
    pub(super) fn has_clock(&self) -> bool {
        self.clock.is_some()
    }

    /// Returns the tick of the board's clock at an instant. `None` if its clock was not read, or another link waits at
    /// the wire.
    pub(super) fn tick_at(&mut self, at: Instant) -> Option<u64> {
        let wire = self.wire.as_mut()?;
        let steady = match wire.steady_begin() {
            Some(begin) => at.saturating_duration_since(begin),
            None => wire.steady_now() + at.saturating_duration_since(Instant::now()),
        };
        Some(self.clock.as_ref()?.tick_at(at, steady))
    }
}

fn nanos(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
