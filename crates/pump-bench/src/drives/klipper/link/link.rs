//! The link of one motor to its board, over a trunk that the motors of the board share.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use super::shared_trunk::{SharedTrunk, TrunkGuard};
use super::trunk::HEED;
use crate::drives::StopRequest;
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::protocol::{Format, Value};
use crate::drives::wire::AskClock;
#[cfg(any(test, all(feature = "grbl", feature = "node")))]
use crate::drives::wire::Wire;

/// Longest time without a confirmation at rest. A computer under load may hold the board's bytes back for as long.
const QUIET: Duration = Duration::from_secs(3);

/// Time after which a question at rest is asked anew: the board sends no answer twice.
const ASK_AGAIN: Duration = Duration::from_millis(250);

/// Longest time for which a link has a trunk that others share.
const SLICE: Duration = Duration::from_millis(1);

/// Place of a board, for the words of errors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::drives::klipper) struct Place {
    /// Path of the port.
    pub(in crate::drives::klipper) port: PathBuf,
    /// Rate of the port, in bits per second.
    pub(in crate::drives::klipper) baud: u32,
}

/// Block with content that came from the board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::drives::klipper) struct Arrival {
    /// Messages, as the dictionary reads them.
    pub(in crate::drives::klipper) content: Vec<u8>,
    /// Time by the wire's steady clock at which the block had come.
    pub(in crate::drives::klipper) at: Duration,
    /// Number of the last block that the board had taken. `None` if it is none of those under way: the board was reset.
    pub(in crate::drives::klipper) taken: Option<u64>,
}

/// Link of a motor to its board.
#[derive(Debug)]
pub(in crate::drives::klipper) struct Link {
    trunk: Arc<SharedTrunk>,
    /// Number of the link's lane.
    lane: u64,
    place: Place,
    stop: StopRequest,
    /// True while a gate hears the user, and no wait does.
    is_deaf: bool,
    quiet: Duration,
    /// Number of times that the board had been found when the motor of this link met it. `None` before. Another motor
    /// that finds the board anew drops what this one has queued.
    found: Option<u64>,
}

impl Drop for Link {
    fn drop(&mut self) {
        self.trunk.lock().close(self.lane);
    }
}

impl Link {
    /// Makes the only link over a wire to the board at a place. [`Self::connect`] comes next.
    #[cfg(any(test, all(feature = "grbl", feature = "node")))]
    pub(in crate::drives::klipper) fn new(wire: Box<dyn Wire>, place: Place, stop: StopRequest) -> Self {
        Self::over(Arc::new(SharedTrunk::new(wire)), place, stop)
    }

    /// Makes one more link over a trunk.
    pub(in crate::drives::klipper) fn over(trunk: Arc<SharedTrunk>, place: Place, stop: StopRequest) -> Self {
        let lane = trunk.lock().open();
        Self { trunk, lane, place, stop, is_deaf: false, quiet: QUIET, found: None }
    }

    /// Returns the number of the link, which no other link of the trunk has.
    pub(in crate::drives::klipper) fn number(&self) -> u64 {
        self.lane
    }

    /// Returns the number of links that share the trunk.
    pub(in crate::drives::klipper) fn links(&self) -> usize {
        self.trunk.lock().lanes()
    }

    /// Returns true if the motor of another link has met the board.
    pub(in crate::drives::klipper) fn is_met_by_others(&self) -> bool {
        self.trunk.lock().is_met_by_others(self.lane)
    }

    /// Notes whether the motor of this link has met the board.
    pub(in crate::drives::klipper) fn note_met(&mut self, is_met: bool) {
        let mut trunk = self.trunk.lock();
        trunk.note_met(self.lane, is_met);
        self.found = is_met.then_some(trunk.connections);
    }

    /// Takes over a board that another motor has found anew. Returns false if it is as this motor has found it.
    pub(in crate::drives::klipper) fn takes_over(&mut self) -> bool {
        let connections = self.trunk.lock().connections;
        let is_anew = self.found.is_some_and(|found| found != connections);
        self.found = self.found.map(|_| connections);
        is_anew
    }

    /// Takes the trunk, unless another motor has found the board anew since this one met it.
    fn hold(&self) -> Result<TrunkGuard<'_>, KlipperError> {
        let trunk = self.trunk.lock();
        match self.found {
            Some(found) if found != trunk.connections => Err(KlipperError::FoundAnew),
            _ => Ok(trunk),
        }
    }

    /// Sets the most bytes under way, which the board holds in its buffer: its constant RECEIVE_WINDOW.
    pub(in crate::drives::klipper) fn set_window(&mut self, bytes: usize) {
        self.trunk.lock().set_window(bytes);
    }

    /// Sets the time without a confirmation after which the link is lost.
    pub(in crate::drives::klipper) fn set_quiet(&mut self, quiet: Duration) {
        self.quiet = quiet;
    }

    /// Has waits hear no request to stop, while a gate does.
    pub(in crate::drives::klipper) fn be_deaf(&mut self, is_deaf: bool) {
        self.is_deaf = is_deaf;
    }

    /// Lets `time` pass.
    pub(in crate::drives::klipper) fn sleep(&mut self, time: Duration) {
        let mut trunk = self.trunk.lock();
        if trunk.lanes() > 1 {
            drop(trunk);
            thread::sleep(time);
        } else {
            trunk.sleep(time);
        }
    }

    /// Returns the clock of a thread that asks for leave while another one has the link.
    pub(in crate::drives::klipper) fn ask_clock(&mut self) -> Box<dyn AskClock> {
        self.trunk.lock().ask_clock()
    }

    /// Returns the time of the wire, which a pause of this program holds up.
    pub(in crate::drives::klipper) fn now(&mut self) -> Duration {
        self.trunk.lock().now()
    }

    /// Returns the time of the wire's steady clock, by which the board's clock is read.
    pub(in crate::drives::klipper) fn steady_now(&mut self) -> Duration {
        self.trunk.lock().steady_now()
    }

    /// Returns the time of the wire's steady clock at an instant.
    pub(in crate::drives::klipper) fn steady_at(&mut self, at: Instant) -> Duration {
        self.trunk.lock().steady_at(at)
    }

    /// Returns the number of blocks that wait to be sent.
    pub(in crate::drives::klipper) fn waiting(&self) -> usize {
        self.trunk.lock().waiting()
    }

    /// Returns the number of blocks that were sent and not confirmed.
    #[cfg(test)]
    pub(in crate::drives::klipper) fn under_way(&self) -> usize {
        self.trunk.lock().under_way()
    }

    /// Returns the time by the steady clock at which a block was sent first. `None` if it was not yet, or long ago.
    pub(in crate::drives::klipper) fn sent_at(&self, number: u64) -> Option<Duration> {
        self.trunk.lock().sent_at(number)
    }

    /// Returns the times between which the board has carried out a question in a block of its own: that at which the
    /// block was first sent, and that at which its answer came. `None` if the arrival is no answer to this block.
    ///
    /// The board answers a question before it takes the next block, so its answer tells the number of the block.
    pub(in crate::drives::klipper) fn answered_within(
        &self,
        number: u64,
        answer: &Arrival,
    ) -> Option<(Duration, Duration)> {
        let sent = self.sent_at(number)?;
        (answer.taken == Some(number)).then_some((sent, answer.at))
    }

    /// Refuses a board that speaks grbl's protocol, before it gets a byte of this one: the sync byte 7Eh lets a grbl
    /// board go on from a hold.
    pub(in crate::drives::klipper) fn refuse_grbl(&mut self) -> Result<(), KlipperError> {
        self.trunk.lock().refuse_grbl(&self.place, &|| self.heed())
    }

    /// Finds the block that the board takes next, and begins there. Nothing that was queued before is sent.
    pub(in crate::drives::klipper) fn connect(&mut self, limit: Duration) -> Result<(), KlipperError> {
        let mut trunk = self.trunk.lock();
        let connected = trunk.connect(limit, &self.place, &|| self.heed());
        let connections = trunk.connections;
        drop(trunk);
        self.found = self.found.map(|_| connections);
        connected
    }

    /// Queues a command, which the next turns send. Commands share blocks. Returns the number of its block.
    pub(in crate::drives::klipper) fn queue(&mut self, command: &[u8]) -> Result<u64, KlipperError> {
        self.hold()?.queue(command)
    }

    /// Queues commands of which the board takes all or none. Returns the number of the first one's block.
    pub(in crate::drives::klipper) fn queue_all(
        &mut self,
        commands: &[Vec<u8>],
    ) -> Result<u64, KlipperError> {
        self.hold()?.queue_all(commands)
    }

    /// Queues a command in a block of its own, as a question whose answer is told by the number of the block.
    pub(in crate::drives::klipper) fn queue_alone(&mut self, command: &[u8]) -> Result<u64, KlipperError> {
        self.hold()?.queue_alone(command)
    }

    /// Returns the oldest block with content that has come. Answers to other links are among them.
    pub(in crate::drives::klipper) fn take(&mut self) -> Option<Arrival> {
        self.trunk.lock().take(self.lane)
    }

    /// Sends what is due, and takes in what has come, for as long as `wait` at most. Returns at the first arrival.
    ///
    /// The link is lost only after all input was read.
    pub(in crate::drives::klipper) fn turn(&mut self, wait: Duration) -> Result<(), KlipperError> {
        let until = self.now() + wait;
        loop {
            let mut trunk = self.hold()?;
            let slice = if trunk.lanes() > 1 { until.min(trunk.now() + SLICE) } else { until };
            trunk.turn(self.lane, slice, self.quiet)?;
            if trunk.has_arrivals(self.lane) || trunk.now() >= until {
                return Ok(());
            }
        }
    }

    /// Waits until the board has taken all that was queued by now. Arrivals are kept.
    pub(in crate::drives::klipper) fn settle(&mut self) -> Result<(), KlipperError> {
        let last = self.hold()?.last();
        let mut arrivals = VecDeque::new();
        while !self.hold()?.has_taken(last) {
            self.heed()?;
            self.turn(HEED)?;
            let mut trunk = self.trunk.lock();
            while let Some(arrival) = trunk.take(self.lane) {
                arrivals.push_back(arrival);
            }
        }
        self.trunk.lock().give_back(self.lane, arrivals);
        Ok(())
    }

    /// Asks a question at rest, and returns its answer: the first arrival of which `answer` makes something. The number
    /// that it is given is that of the question's block, as [`Self::answered_within`] needs it. Other arrivals are
    /// kept. The question is asked anew until it is answered, so it must change nothing.
    pub(in crate::drives::klipper) fn ask<T>(
        &mut self,
        question: &Format,
        values: &[Value<'_>],
        mut answer: impl FnMut(&Self, u64, &Arrival) -> Result<Option<T>, KlipperError>,
    ) -> Result<T, KlipperError> {
        let command = question.encode(values)?;
        let mut others = VecDeque::new();
        let began = self.now();
        let answered = loop {
            let number = self.queue_alone(&command)?;
            let asked = self.now();
            let mut answered = None;
            loop {
                // A thread that was held up has the answer, although its time is over.
                let waits = self.waits_for(number, asked);
                self.heed()?;
                self.turn(if waits { HEED } else { Duration::ZERO })?;
                while let Some(arrival) = self.take() {
                    // An answer that was on its way before is that to another question, perhaps of another motor.
                    if arrival.taken.is_none_or(|taken| taken >= number) {
                        answered = answer(self, number, &arrival)?;
                    }
                    if answered.is_some() {
                        break;
                    }
                    others.push_back(arrival);
                }
                if answered.is_some() || !waits {
                    break;
                }
            }
            let waited = self.now().saturating_sub(began);
            match answered {
                Some(answered) => break answered,
                None if waited < self.quiet => {}
                None => {
                    let (question, waited_s) = (question.name().to_owned(), waited.as_secs_f64());
                    return Err(KlipperError::NoAnswer { question, waited_s });
                }
            }
        };
        self.trunk.lock().give_back(self.lane, others);
        Ok(answered)
    }

    /// Returns true while the answer to a question may still come that was asked in the block of this number.
    fn waits_for(&self, number: u64, asked: Duration) -> bool {
        let mut trunk = self.trunk.lock();
        let waited = trunk.now().saturating_sub(asked);
        waited < ASK_AGAIN || !trunk.has_taken(number) && waited < self.quiet
    }

    /// Refuses to go on at rest if the user asked to stop.
    pub(in crate::drives::klipper) fn heed(&self) -> Result<(), KlipperError> {
        if self.stop.is_made() && !self.is_deaf { Err(KlipperError::Interrupted) } else { Ok(()) }
    }
}
