//! A conversation with a board: one line at a time, and a question for its position now and then.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::error::GrblError;
use super::port::Port;
use super::reply::{Replies, Reply, State, Status};

/// Time between two questions for the position. grbl's documentation asks for at most five to ten a second of
/// a slow machine's user interface. A board answers hundreds.
pub(super) const POLL: Duration = Duration::from_millis(50);

/// Silence after a question from which on a board is out of reach.
const SILENCE: Duration = Duration::from_secs(2);

/// Longest wait for a line to be acknowledged.
pub(super) const OK_LIMIT: Duration = Duration::from_secs(5);

/// Longest wait for bytes before something else may be due.
const SLICE: Duration = Duration::from_millis(5);

/// Byte that asks for a status report. The board takes it from the stream at once, wherever it stands.
const QUESTION: u8 = b'?';

/// Message of a board.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Heard {
    /// Any reply that is not a status report.
    Reply(Reply),
    /// A status report, with the axis's coordinate if it can be known, in mm or inches.
    Status(State, Option<f64>),
}

/// Board at the other end of a port.
#[derive(Debug)]
pub(super) struct Board {
    port: Port,
    replies: Replies,
    waiting: VecDeque<Reply>,
    /// Number of the axis in reports.
    axis: usize,
    /// Offset `WCO` of the axis, once it was reported.
    offset: Option<f64>,
    asked: Option<Instant>,
    unanswered: Option<Instant>,
}

impl Board {
    /// Talks through `port` to the axis of this number.
    pub(super) fn new(port: Port, axis: usize) -> Self {
        Self {
            port,
            replies: Replies::default(),
            waiting: VecDeque::new(),
            axis,
            offset: None,
            asked: None,
            unanswered: None,
        }
    }

    /// Sends a line.
    pub(super) fn send(&mut self, line: &str) -> Result<(), GrblError> {
        self.port.write(format!("{line}\n").as_bytes())
    }

    /// Sends a byte that takes effect at once.
    pub(super) fn send_byte(&mut self, byte: u8) -> Result<(), GrblError> {
        self.port.write(&[byte])
    }

    /// Asks for a status report.
    pub(super) fn ask(&mut self) -> Result<(), GrblError> {
        let now = Instant::now();
        self.asked = Some(now);
        self.unanswered.get_or_insert(now);
        self.send_byte(QUESTION)
    }

    /// Waits a moment for something to be said, and asks for the position whenever it is due.
    pub(super) fn listen(&mut self) -> Result<Option<Heard>, GrblError> {
        if self.asked.is_none_or(|asked| asked.elapsed() >= POLL) {
            self.ask()?;
        }
        let heard = self.hear(SLICE)?;
        if heard.is_none()
            && let Some(since) = self.unanswered.filter(|since| since.elapsed() > SILENCE)
        {
            return Err(GrblError::Quiet { waited_s: since.elapsed().as_secs_f64() });
        }
        Ok(heard)
    }

    /// Waits until something is said or `wait` has passed.
    pub(super) fn hear(&mut self, wait: Duration) -> Result<Option<Heard>, GrblError> {
        let until = Instant::now() + wait;
        loop {
            if let Some(reply) = self.waiting.pop_front() {
                return Ok(Some(self.understand(reply)));
            }
            let mut bytes = [0; 256];
            let count = self.port.read(&mut bytes, until.saturating_duration_since(Instant::now()))?;
            let mut replies = Vec::new();
            self.replies.feed(bytes.get(..count).unwrap_or_default(), &mut replies);
            self.waiting.extend(replies);
            if self.waiting.is_empty() && Instant::now() >= until {
                return Ok(None);
            }
        }
    }

    fn understand(&mut self, reply: Reply) -> Heard {
        match reply {
            Reply::Status(status) => {
                self.unanswered = None;
                let place = self.place(&status);
                Heard::Status(status.state, place)
            }
            Reply::Banner(_) => {
                self.unanswered = None;
                self.offset = None;
                Heard::Reply(reply)
            }
            Reply::Unknown(_) => Heard::Reply(reply),
            _ => {
                self.unanswered = None;
                Heard::Reply(reply)
            }
        }
    }

    fn place(&mut self, status: &Status) -> Option<f64> {
        let of = |numbers: &Option<Vec<f64>>| numbers.as_ref()?.get(self.axis).copied();
        let (machine, work, offset) = (of(&status.machine), of(&status.work), of(&status.offset));
        self.offset = offset.or(self.offset);
        machine.or_else(|| Some(work? + self.offset?))
    }

    /// Sends a line and waits until it is acknowledged. Returns the replies before that, without status
    /// reports.
    ///
    /// Asks nothing meanwhile: while a board stores a setting, it loses what it is sent.
    pub(super) fn command(&mut self, line: &str) -> Result<Vec<Reply>, GrblError> {
        self.send(line)?;
        let started = Instant::now();
        let mut said = Vec::new();
        loop {
            if let Some(Heard::Reply(reply)) = self.hear(SLICE)? {
                match reply {
                    Reply::Ok => return Ok(said),
                    Reply::Error(code) => return Err(GrblError::Refused { line: line.to_owned(), code }),
                    Reply::Banner(_) => return Err(GrblError::Reset),
                    Reply::Alarm(code) => return Err(GrblError::Alarm { code }),
                    other => said.push(other),
                }
            }
            if started.elapsed() > OK_LIMIT {
                let waited_s = started.elapsed().as_secs_f64();
                return Err(GrblError::NoOk { line: line.to_owned(), waited_s });
            }
        }
    }

    /// Asks for the state and waits for an answer that is newer than the question. Calls `at_banner` if the
    /// board was reset.
    pub(super) fn state(&mut self, mut at_banner: impl FnMut()) -> Result<State, GrblError> {
        while let Some(heard) = self.hear(Duration::ZERO)? {
            if let Heard::Reply(Reply::Banner(_)) = heard {
                at_banner();
            }
        }
        self.ask()?;
        loop {
            match self.listen()? {
                Some(Heard::Status(state, _)) => return Ok(state),
                Some(Heard::Reply(Reply::Banner(_))) => at_banner(),
                _ => {}
            }
        }
    }

    /// Returns the reported position of the axis of a board at rest. A board at rest sends `WCO` only in
    /// every tenth report.
    pub(super) fn rests_at(&mut self) -> Result<f64, GrblError> {
        let started = Instant::now();
        while started.elapsed() < OK_LIMIT {
            match self.listen()? {
                Some(Heard::Status(State::Idle, Some(place))) => return Ok(place),
                Some(Heard::Reply(Reply::Banner(_))) => return Err(GrblError::Reset),
                _ => {}
            }
        }
        Err(GrblError::NoPosition { waited_s: started.elapsed().as_secs_f64() })
    }
}
