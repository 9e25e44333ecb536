//! The link of an axis to its board: requests out, answers in. The axes of one board share its line.

use std::sync::{Arc, MutexGuard};
use std::time::{Duration, Instant};

use pump_link::message::Request;

use super::error::NodeError;
use super::line::{Line, Reply, Subject};
use super::shared_line::SharedLine;
use crate::drives::StopRequest;
use crate::drives::wire::{AskClock, SystemAskClock};
use crate::pump_file::Axis;

/// Longest time for which a silent board is asked again. A board that still runs needs milliseconds, and a computer
/// under load may hold its answers back for much longer.
pub(super) const PATIENCE: Duration = Duration::from_secs(3);

/// Link of one axis to its board.
#[derive(Debug)]
pub(super) struct Link {
    line: Arc<SharedLine>,
    /// Number of the axis, by which its answers are told from others'.
    lane: u8,
    /// Session in which the board was met. It is 0 before.
    session: u64,
    /// Number of losses of the line that this link has heard of.
    losses: u32,
    stop: StopRequest,
    /// True while a gate hears the user in place of the link.
    pub(super) is_deaf: bool,
    /// True while the thread of the link streams.
    streams: bool,
    /// True if one thread gives this link and others their turns.
    takes_turns: bool,
}

impl Link {
    /// Makes the link of `axis` over a line, without a session. No other link may have the axis.
    pub(super) fn new(line: Arc<SharedLine>, axis: Axis, stop: StopRequest) -> Result<Self, NodeError> {
        let lane = axis as u8;
        let taken = line.lock().lane(lane).is_some_and(|lane| std::mem::replace(&mut lane.is_taken, true));
        if taken {
            return Err(NodeError::Twice { axis });
        }
        let (session, losses, is_deaf, streams, takes_turns) = (0, 0, false, false, false);
        Ok(Self { line, lane, session, losses, stop, is_deaf, streams, takes_turns })
    }

    /// Returns the number of the axis.
    pub(super) fn lane(&self) -> u8 {
        self.lane
    }

    pub(super) fn line(&self) -> MutexGuard<'_, Line> {
        self.line.lock()
    }

    /// Returns the line, which links of other axes share.
    pub(super) fn shared(&self) -> &Arc<SharedLine> {
        &self.line
    }

    /// Begins with no request under way, in this session.
    pub(super) fn begin(&mut self, session: u64) {
        self.line().begin(session);
        self.session = session;
    }

    /// Joins the session of the line, which other axes have.
    pub(super) fn join(&mut self) {
        let session = self.line().session();
        self.session = session;
    }

    /// Returns the session of this side.
    pub(super) fn session(&self) -> u64 {
        self.session
    }

    /// Returns the time of the wire.
    pub(super) fn now(&mut self) -> Duration {
        self.line().now()
    }

    /// Returns the clock of the thread that asks for leave meanwhile.
    pub(super) fn ask_clock(&mut self) -> Box<dyn AskClock> {
        let clock = self.line.with_wire(|wire| wire.ask_clock());
        clock.unwrap_or_else(|| Box::new(SystemAskClock::default()))
    }

    /// Waits until no other axis meets the board, and hears the user meanwhile.
    pub(super) fn meeting<'l>(&self, line: &'l SharedLine) -> Result<MutexGuard<'l, ()>, NodeError> {
        loop {
            self.heed()?;
            match line.try_meeting() {
                Some(meeting) => return Ok(meeting),
                None => std::thread::sleep(Duration::from_millis(5)),
            }
        }
    }

    /// Notes that a thread streams over this link, which takes turns with others if they have the same thread.
    pub(super) fn be_streaming(&mut self, streams: bool, takes_turns: bool) {
        (self.streams, self.takes_turns) = (streams, takes_turns);
    }

    /// Returns the error of a board that was last heard some time ago.
    pub(super) fn quiet(&mut self) -> NodeError {
        self.line().quiet()
    }

    /// Returns the time of the board's last answer, to any of its axes.
    pub(super) fn heard_at(&self) -> Duration {
        self.line().heard_at()
    }

    /// Has the board's clock followed from now on. Returns the time over which it was read.
    pub(super) fn follow_clock(&mut self) -> Duration {
        let mut line = self.line();
        line.follows_clock = true;
        line.clock_span()
    }

    /// Returns true if the board's clock was read.
    pub(super) fn has_clock(&mut self) -> bool {
        self.line.with_free(|line| line.has_clock())
    }

    /// Returns the tick of the board's clock at an instant. `None` if its clock was not read.
    pub(super) fn tick_at(&mut self, at: Instant) -> Option<u64> {
        self.line.with_free(|line| line.tick_at(at))
    }

    /// Has the requests under way sent again after a lost link.
    pub(super) fn renew(&mut self) {
        self.line().renew();
    }

    /// Lets `time` pass.
    pub(super) fn sleep(&mut self, time: Duration) {
        if self.line.with_wire(|wire| wire.sleep(time)).is_none() {
            std::thread::sleep(time);
        }
    }

    /// Refuses to go on if the user asked to stop.
    pub(super) fn heed(&self) -> Result<(), NodeError> {
        if !self.is_deaf && self.stop.is_made() { Err(NodeError::Interrupted) } else { Ok(()) }
    }

    /// Returns the number of requests of this link under way that have this subject.
    pub(super) fn under_way(&self, subject: Subject) -> usize {
        self.line().under_way(self.lane, subject)
    }

    /// Takes a request, which is sent by the next turn. A link whose board was met anew since has no session.
    pub(super) fn request(&mut self, request: &Request<'_>, subject: Subject) -> Result<(), NodeError> {
        let mut line = self.line.lock();
        if line.session() != self.session {
            return Err(NodeError::Reset);
        }
        if !line.has_asked(self.lane) {
            self.losses = line.losses;
        }
        line.request(self.lane, request, subject)
    }

    /// Forgets this link's requests under way.
    pub(super) fn clear(&mut self) {
        self.line().forget(self.lane);
    }

    /// Sends what is due, and takes in answers for as long as `wait` at most. Returns at the first answers. A link that
    /// takes turns returns at those of others, too.
    ///
    /// The link is lost only after all input was read.
    pub(super) fn turn(&mut self, wait: Duration, replies: &mut Vec<Reply>) -> Result<(), NodeError> {
        let shared = Arc::clone(&self.line);
        let mut line = shared.lock();
        let until = line.now() + wait;
        loop {
            line.send();
            line.collect(self.lane, replies);
            let is_lost = line.losses != self.losses && line.has_asked(self.lane);
            if is_lost {
                self.losses = line.losses;
                return Err(line.quiet());
            }
            line.check()?;
            let others = self.takes_turns && !line.inbox_is_empty();
            if !replies.is_empty() || others || line.now() >= until {
                return Ok(());
            }
            line = shared.wait(line, until, self.streams);
        }
    }

    /// Asks one request at rest, and waits for its answer. A silent board is asked again for as long as in motion.
    pub(super) fn ask(&mut self, request: &Request<'_>) -> Result<Reply, NodeError> {
        self.request(request, Subject::Single)?;
        let began = self.now();
        loop {
            match self.answer() {
                Err(NodeError::Quiet { .. }) if self.now().saturating_sub(began) < PATIENCE => {
                    self.renew();
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

    /// Lets time pass, and drops late answers. A link that takes turns returns early where another has answers.
    pub(super) fn pass(&mut self, time: Duration) -> Result<(), NodeError> {
        let shared = Arc::clone(&self.line);
        let mut line = shared.lock();
        let until = line.now() + time;
        loop {
            line.drop_answers(self.lane);
            line.check()?;
            if line.now() >= until || self.takes_turns && !line.inbox_is_empty() {
                return Ok(());
            }
            line = shared.wait(line, until, self.streams);
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        let mut line = self.line.lock();
        line.forget(self.lane);
        if let Some(lane) = line.lane(self.lane) {
            *lane = Default::default();
        }
    }
}
