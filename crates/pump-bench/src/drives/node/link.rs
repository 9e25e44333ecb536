//! The link to a board: requests out, answers in. The axes of one board share its line.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use pump_link::message::{AXES, Request};

use super::error::NodeError;
use super::line::{Line, Reply, Subject};
use crate::drives::StopRequest;
use crate::drives::wire::{AskClock, Wire};

/// Longest wait for an answer that is not there yet, before the link looks at its times.
const LOOK: Duration = Duration::from_millis(5);

/// Longest time for which a silent board is asked again. A board that still runs needs milliseconds, and a computer
/// under load may hold its answers back for much longer.
pub(super) const PATIENCE: Duration = Duration::from_secs(3);

/// Link of one axis to its board.
#[derive(Debug)]
pub(super) struct Link {
    line: Arc<Mutex<Line>>,
    /// Number of the link among those of the line, by which its answers are told from others'.
    lane: u8,
    stop: StopRequest,
    /// True while a gate hears the user in place of the link.
    pub(super) is_deaf: bool,
}

impl Link {
    /// Makes the link over `wire`, without a session.
    pub(super) fn new(wire: Box<dyn Wire>, stop: StopRequest) -> Self {
        Self { line: Arc::new(Mutex::new(Line::new(wire))), lane: 0, stop, is_deaf: false }
    }

    /// Makes a link for each of so many axes over `wire`, one line for all.
    pub(super) fn several(wire: Box<dyn Wire>, stop: &StopRequest, axes: usize) -> Vec<Self> {
        let line = Arc::new(Mutex::new(Line::new(wire)));
        let axes = axes.min(AXES) as u8;
        let link = |lane| Self { line: Arc::clone(&line), lane, stop: stop.clone(), is_deaf: false };
        (0..axes).map(link).collect()
    }

    pub(super) fn line(&self) -> MutexGuard<'_, Line> {
        self.line.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins with no request under way, in this session.
    pub(super) fn begin(&mut self, session: u64) {
        self.line().begin(session);
    }

    /// Returns the session of this side.
    pub(super) fn session(&self) -> u64 {
        self.line().session()
    }

    /// Returns the time of the wire.
    pub(super) fn now(&mut self) -> Duration {
        self.line().wire.now()
    }

    /// Returns the clock of a thread that asks for leave while another one has the wire.
    pub(super) fn ask_clock(&mut self) -> Box<dyn AskClock> {
        self.line().wire.ask_clock()
    }

    /// Returns the error of a board that was last heard some time ago.
    pub(super) fn quiet(&mut self) -> NodeError {
        self.line().quiet()
    }

    /// Lets `time` pass.
    pub(super) fn sleep(&mut self, time: Duration) {
        self.line().wire.sleep(time);
    }

    /// Refuses to go on if the user asked to stop.
    pub(super) fn heed(&self) -> Result<(), NodeError> {
        if !self.is_deaf && self.stop.is_made() { Err(NodeError::Interrupted) } else { Ok(()) }
    }

    /// Returns the number of requests of this link under way that have this subject.
    pub(super) fn under_way(&self, subject: Subject) -> usize {
        self.line().under_way(self.lane, subject)
    }

    /// Takes a request, which is sent by the next turn.
    pub(super) fn request(&mut self, request: &Request<'_>, subject: Subject) -> Result<(), NodeError> {
        self.line().request(self.lane, request, subject)
    }

    /// Forgets this link's requests under way.
    pub(super) fn clear(&mut self) {
        self.line().forget(self.lane);
    }

    /// Sends what is due, and takes in answers for as long as `wait` at most. Returns at the first answers, those of
    /// other axes included.
    ///
    /// The link is lost only after all input was read.
    pub(super) fn turn(&mut self, wait: Duration, replies: &mut Vec<Reply>) -> Result<(), NodeError> {
        let lane = self.lane;
        let mut line = self.line();
        let until = line.wire.now() + wait;
        loop {
            line.send()?;
            if line.inbox_is_empty() {
                let left = until.saturating_sub(line.wire.now());
                line.take(left.min(LOOK))?;
            }
            while line.take(Duration::ZERO)? {}
            line.collect(lane, replies);
            line.expire()?;
            let now = line.wire.now();
            if !replies.is_empty() || !line.inbox_is_empty() || now >= until {
                return line.send();
            }
        }
    }

    /// Asks one request at rest, and waits for its answer. A silent board is asked again for as long as in motion.
    pub(super) fn ask(&mut self, request: &Request<'_>) -> Result<Reply, NodeError> {
        self.request(request, Subject::Single)?;
        let began = self.now();
        loop {
            match self.answer() {
                Err(NodeError::Quiet { .. }) if self.now().saturating_sub(began) < PATIENCE => {
                    self.line().renew();
                }
                Err(NodeError::Quiet { waited_s }) => {
                    // The board had no word to say between two requests.
                    let asked_s = self.now().saturating_sub(began).as_secs_f64();
                    return Err(NodeError::Quiet { waited_s: waited_s.min(asked_s) });
                }
                reply => return reply,
            }
        }
    }

    /// Asks one request at rest, and takes a few lost answers for silence.
    pub(super) fn ask_once(&mut self, request: &Request<'_>) -> Result<Reply, NodeError> {
        self.request(request, Subject::Single)?;
        self.answer()
    }

    /// Waits for the answer to the request at rest.
    fn answer(&mut self) -> Result<Reply, NodeError> {
        let mut replies = Vec::new();
        loop {
            self.heed()?;
            self.turn(Duration::from_millis(20), &mut replies)?;
            if let Some(reply) = replies.drain(..).find(|reply| reply.subject == Subject::Single) {
                return Ok(reply);
            }
        }
    }

    /// Lets time pass, and drops late answers. Returns early where another axis has answers.
    pub(super) fn pass(&mut self, time: Duration) -> Result<(), NodeError> {
        let lane = self.lane;
        let mut line = self.line();
        let until = line.wire.now() + time;
        while line.wire.now() < until && line.inbox_is_empty() {
            let left = until.saturating_sub(line.wire.now());
            line.take(left.min(LOOK))?;
            line.drop_answers(lane);
        }
        Ok(())
    }
}
