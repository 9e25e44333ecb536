//! A conversation with a board: one line at a time, and a question for its position now and then.
//!
//! A board may say anything at any time, without end. So every wait has a deadline that no reply moves, and
//! every wait at rest hears the user's request to stop.

use std::collections::VecDeque;
use std::io;
use std::sync::Arc;
use std::time::Duration;

use super::error::GrblError;
use super::reply::{BoardState, BoardStatus, Replies, Reply};
use crate::drives::StopRequest;
use crate::drives::wire::Wire;

/// Time between two questions for the position. grbl's documentation asks for at most five to ten a second of
/// a slow machine's user interface. A board answers hundreds.
pub(super) const POLL: Duration = Duration::from_millis(50);

/// Time without a report after a question from which on a board is out of reach.
const SILENCE: Duration = Duration::from_secs(2);

/// Longest wait for a line to be acknowledged.
pub(super) const OK_LIMIT: Duration = Duration::from_secs(5);

/// Longest wait for bytes before something else may be due.
const SLICE: Duration = Duration::from_millis(5);

/// Longest wait for a report of the state of a board that is within reach.
const STATE_LIMIT: Duration = Duration::from_secs(5);

/// Longest time for which replies are read that were there already.
const BACKLOG: Duration = Duration::from_millis(50);

/// Most replies to one line that are kept. A list of settings has about a hundred lines.
const MOST_REPLIES: usize = 2000;

/// Byte that asks for a status report. The board takes it from the stream at once, wherever it stands.
const QUESTION: u8 = b'?';

/// Message of a board.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Heard {
    /// Any reply that is not a status report.
    Reply(Reply),
    /// A status report, with the axis's coordinate if it can be known, in mm or inches.
    Status(BoardState, Option<f64>),
}

/// Board at the other end of a wire.
#[derive(Debug)]
pub(super) struct Board {
    wire: Box<dyn Wire>,
    replies: Replies,
    waiting: VecDeque<Reply>,
    /// Number of the axis in reports.
    axis: usize,
    /// Offset `WCO` of each axis, once it was reported.
    offset: Option<Vec<f64>>,
    /// Machine coordinate of each axis in the last status report, in mm or inches. Empty if it told none.
    places: Vec<f64>,
    /// Number of axes in the last report of a position.
    axes: usize,
    asked: Option<Duration>,
    unanswered: Option<Duration>,
    /// Time at which the last status report was asked for. The report is not older.
    answered: Duration,
    /// Number of lines whose acknowledgement nobody waited for. Their answers belong to no later line.
    owed: usize,
    stop: StopRequest,
    /// Number of resets that the board has told.
    resets: u32,
    /// True once the connection has broken.
    is_gone: bool,
    /// True while waits go on although the user asked to stop: the motor turns, or its rest is looked at.
    deaf: bool,
}

impl Board {
    /// Talks through `wire` to the axis of this number. Waits at rest end once `stop` is made.
    pub(super) fn new(wire: Box<dyn Wire>, axis: usize, stop: StopRequest) -> Self {
        Self {
            wire,
            replies: Replies::default(),
            waiting: VecDeque::new(),
            axis,
            offset: None,
            places: Vec::new(),
            axes: 0,
            asked: None,
            unanswered: None,
            answered: Duration::ZERO,
            owed: 0,
            stop,
            resets: 0,
            is_gone: false,
            deaf: false,
        }
    }

    /// Talks to this axis from now on. Waits at rest end once `stop` is made.
    pub(super) fn attend(&mut self, axis: usize, stop: &StopRequest) {
        self.attend_axis(axis);
        self.stop = stop.clone();
    }

    /// Tells the place of this axis from now on.
    pub(super) fn attend_axis(&mut self, axis: usize) {
        self.axis = axis;
    }

    /// Returns the number of resets that the board has told since its port was opened.
    pub(super) fn resets(&self) -> u32 {
        self.resets
    }

    /// Returns true once the connection has broken.
    pub(super) fn is_gone(&self) -> bool {
        self.is_gone
    }

    /// Returns the time since the wire was opened.
    pub(super) fn now(&mut self) -> Duration {
        self.wire.now()
    }

    /// Returns the time at which the last status report was asked for. What it tells is not older.
    pub(super) fn reported_since(&self) -> Duration {
        self.answered
    }

    /// Lets waits go on, or not, although the user asked to stop. Returns what they did before.
    pub(super) fn be_deaf(&mut self, deaf: bool) -> bool {
        std::mem::replace(&mut self.deaf, deaf)
    }

    /// Makes `talk` with waits that go on although the user asked to stop.
    pub(super) fn undisturbed<T>(&mut self, talk: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.be_deaf(true);
        let result = talk(self);
        self.be_deaf(before);
        result
    }

    /// Refuses to wait at rest once the user asked to stop.
    pub(super) fn heed(&self) -> Result<(), GrblError> {
        if !self.deaf && self.stop.is_made() { Err(GrblError::Interrupted) } else { Ok(()) }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), GrblError> {
        self.wire.write(bytes).map_err(|error| self.gone(error))
    }

    fn gone(&mut self, error: io::Error) -> GrblError {
        self.is_gone = true;
        GrblError::Gone(Arc::new(error))
    }

    /// Sends a line.
    pub(super) fn send(&mut self, line: &str) -> Result<(), GrblError> {
        self.write(format!("{line}\n").as_bytes())
    }

    /// Sends a byte that takes effect at once.
    pub(super) fn send_byte(&mut self, byte: u8) -> Result<(), GrblError> {
        self.write(&[byte])
    }

    /// Asks for a status report.
    pub(super) fn ask(&mut self) -> Result<(), GrblError> {
        self.note_question();
        self.send_byte(QUESTION)
    }

    /// Sends a line with a question for the position before its end. The board takes the question from the
    /// stream, and answers it before it obeys the line.
    pub(super) fn send_with_question(&mut self, line: &str) -> Result<(), GrblError> {
        self.note_question();
        let question = char::from(QUESTION);
        self.write(format!("{line}{question}\n").as_bytes())
    }

    fn note_question(&mut self) {
        let now = self.now();
        self.asked = Some(now);
        self.unanswered.get_or_insert(now);
    }

    /// Waits a moment for something to be said, and asks for the position whenever it is due.
    pub(super) fn listen(&mut self) -> Result<Option<Heard>, GrblError> {
        let now = self.now();
        if self.asked.is_none_or(|asked| now - asked >= POLL) {
            self.ask()?;
        }
        let heard = self.hear(SLICE)?;
        let waited = self.now() - self.unanswered.unwrap_or(now);
        if self.unanswered.is_some() && waited > SILENCE {
            return Err(GrblError::Quiet { waited_s: waited.as_secs_f64() });
        }
        Ok(heard)
    }

    /// Waits until something is said or `wait` has passed.
    pub(super) fn hear(&mut self, wait: Duration) -> Result<Option<Heard>, GrblError> {
        let until = self.now() + wait;
        loop {
            self.heed()?;
            if let Some(reply) = self.waiting.pop_front() {
                if self.owed > 0 && matches!(reply, Reply::Ok | Reply::Error(_)) {
                    self.owed -= 1;
                    continue;
                }
                return Ok(Some(self.understand(reply)));
            }
            let mut bytes = [0; 256];
            let left = until.saturating_sub(self.now()).min(SLICE);
            let count = self.wire.read(&mut bytes, left).map_err(|error| self.gone(error))?;
            let mut replies = Vec::new();
            self.replies.feed(bytes.get(..count).unwrap_or_default(), &mut replies);
            self.waiting.extend(replies);
            if self.waiting.is_empty() && self.now() >= until {
                return Ok(None);
            }
        }
    }

    /// Gives every reply of the next `wait` to `each`, and those that are there already.
    pub(super) fn hear_all(
        &mut self,
        wait: Duration,
        mut each: impl FnMut(Heard) -> Result<(), GrblError>,
    ) -> Result<(), GrblError> {
        let until = self.now() + wait;
        loop {
            let left = until.saturating_sub(self.now());
            match self.hear(left)? {
                Some(heard) => each(heard)?,
                None if left.is_zero() => return Ok(()),
                None => {}
            }
            if self.now() >= until + BACKLOG {
                return Ok(());
            }
        }
    }

    fn understand(&mut self, reply: Reply) -> Heard {
        match reply {
            Reply::Status(status) => {
                self.answered = self.unanswered.take().or(self.asked).unwrap_or(self.answered);
                let reported = status.machine.as_ref().or(status.work.as_ref());
                self.axes = reported.map_or(self.axes, Vec::len);
                self.places = self.places(&status);
                Heard::Status(status.state, self.place_of(self.axis))
            }
            Reply::Banner(_) => {
                self.unanswered = None;
                self.offset = None;
                self.owed = 0;
                self.resets += 1;
                Heard::Reply(reply)
            }
            _ => Heard::Reply(reply),
        }
    }

    fn places(&mut self, status: &BoardStatus) -> Vec<f64> {
        if let Some(offset) = &status.offset {
            self.offset = Some(offset.clone());
        }
        match (&status.machine, &status.work, &self.offset) {
            (Some(machine), ..) => machine.clone(),
            (None, Some(work), Some(offset)) => {
                work.iter().zip(offset).map(|(work, offset)| work + offset).collect()
            }
            _ => Vec::new(),
        }
    }

    /// Returns the coordinate of an axis in the last status report, in mm or inches.
    pub(super) fn place_of(&self, axis: usize) -> Option<f64> {
        self.places.get(axis).copied()
    }

    /// Sends a line and waits until it is acknowledged. Returns the replies before that, without status
    /// reports.
    ///
    /// Asks nothing meanwhile: while a board stores a setting, it loses what it is sent.
    pub(super) fn command(&mut self, line: &str) -> Result<Vec<Reply>, GrblError> {
        self.heed()?;
        self.send(line)?;
        let started = self.now();
        let mut said = Vec::new();
        loop {
            let heard = self.hear(SLICE).inspect_err(|error| {
                self.owed += usize::from(matches!(error, GrblError::Interrupted));
            })?;
            if let Some(Heard::Reply(reply)) = heard {
                match reply {
                    Reply::Ok => {
                        // A board that acknowledges a line is within reach.
                        self.unanswered = None;
                        return Ok(said);
                    }
                    Reply::Error(code) => return Err(GrblError::Refused { line: line.to_owned(), code }),
                    Reply::Banner(_) => return Err(GrblError::Reset),
                    Reply::Alarm(code) => return Err(GrblError::Alarm { code }),
                    other if said.len() < MOST_REPLIES => said.push(other),
                    _ => {}
                }
            }
            let waited = self.now() - started;
            if waited > OK_LIMIT {
                return Err(GrblError::NoOk { line: line.to_owned(), waited_s: waited.as_secs_f64() });
            }
        }
    }

    /// Sends the first line to a board, as [`Self::command`] does. Another program may have left a piece of a line in
    /// the board, which refuses the piece with this line. Then the line is sent again. The piece alone is never ended:
    /// it could be one that moves the motor.
    pub(super) fn first_command(&mut self, line: &str) -> Result<Vec<Reply>, GrblError> {
        match self.command(line) {
            Err(GrblError::Refused { .. }) => self.command(line),
            answer => answer,
        }
    }

    /// Asks for the state and waits for an answer that is newer than the question. Calls `at_banner` if the
    /// board was reset. A board that is reset again and again answers nothing, and is out of reach after a while.
    pub(super) fn state(&mut self, mut at_banner: impl FnMut()) -> Result<BoardState, GrblError> {
        let is_banner = |heard: &Heard| matches!(heard, Heard::Reply(Reply::Banner(_)));
        self.hear_all(Duration::ZERO, |heard| {
            if is_banner(&heard) {
                at_banner();
            }
            Ok(())
        })?;
        self.ask()?;
        let started = self.now();
        loop {
            match self.listen()? {
                Some(Heard::Status(state, _)) => return Ok(state),
                Some(heard) if is_banner(&heard) => at_banner(),
                _ => {}
            }
            let waited = self.now() - started;
            if waited > STATE_LIMIT {
                return Err(GrblError::Quiet { waited_s: waited.as_secs_f64() });
            }
        }
    }

    /// Returns the number of axes that the board reports, or 0 before it has reported a position.
    pub(super) fn axes(&self) -> usize {
        self.axes
    }

    /// Refuses a board whose reports have fewer coordinates than the axis needs. A report may be damaged on its way, so
    /// two of them have to agree.
    pub(super) fn needs_axis(&mut self) -> Result<(), GrblError> {
        let is_missing = |board: &Self| (1..=board.axis).contains(&board.axes);
        if is_missing(self) {
            let before = std::mem::take(&mut self.axes);
            self.state(|| ())?;
            if is_missing(self) && self.axes == before {
                return Err(GrblError::NoAxis { axis: self.axis, axes: self.axes });
            }
        }
        Ok(())
    }

    /// Returns the reported position of the axis of a board at rest, once it was reported twice in a row. A
    /// board at rest sends `WCO` only in every tenth report.
    pub(super) fn rests_at(&mut self) -> Result<f64, GrblError> {
        let started = self.now();
        let mut before = None;
        while self.now() - started < OK_LIMIT {
            match self.listen()? {
                Some(Heard::Status(BoardState::Idle, Some(place))) if before == Some(place) => {
                    return Ok(place);
                }
                Some(Heard::Status(BoardState::Idle, Some(place))) => {
                    before = Some(place);
                    self.ask()?;
                }
                Some(Heard::Reply(Reply::Banner(_))) => return Err(GrblError::Reset),
                _ => {}
            }
        }
        Err(GrblError::NoPosition { waited_s: (self.now() - started).as_secs_f64() })
    }

    /// Lets `time` pass and discards what is heard.
    pub(super) fn pass(&mut self, time: Duration) -> Result<(), GrblError> {
        self.hear_all(time, |_| Ok(()))
    }

    /// Lets `time` pass without a look at the wire.
    pub(super) fn sleep(&mut self, time: Duration) {
        self.wire.sleep(time);
    }

    /// Sends `byte` five times to a board that does not answer, as far as the wire takes it.
    pub(super) fn call_out(&mut self, byte: u8) {
        for _ in 0..5 {
            if self.send_byte(byte).is_err() {
                return;
            }
            self.wire.sleep(POLL);
        }
    }
}
