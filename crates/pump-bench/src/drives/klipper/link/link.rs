//! The link over a wire.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::grbl_report;
use super::window::Window;
use crate::drives::StopRequest;
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::protocol::{
    BLOCK_MOST, Block, BlockReader, CONTENT_MOST, Format, MessageError, SYNC, Value, block,
};
use crate::drives::wire::{AskClock, Wire};

/// Longest time without a confirmation at rest. A computer under load may hold the board's bytes back for as long.
const QUIET: Duration = Duration::from_secs(3);

/// Time after which a question at rest is asked anew: the board sends no answer twice.
const ASK_AGAIN: Duration = Duration::from_millis(250);

/// Time for which the board is given to answer while it is being found.
const FIND_AGAIN: Duration = Duration::from_millis(100);

/// Longest wait at rest before the user is heard.
const HEED: Duration = Duration::from_millis(20);

/// Time for which a grbl board's report is waited for. It comes within some ms.
const REPORT: Duration = Duration::from_millis(200);

/// Most bytes in which a report is looked for.
const HEARD_MOST: usize = 4096;

/// Most reads of one turn before it sends. A board that never pauses is a fault of its own.
const READS_MOST: usize = 64;

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

/// Blocks that wait to be sent.
#[derive(Debug, Default)]
struct Waiting {
    contents: VecDeque<Vec<u8>>,
    /// True if the last block takes no further command.
    is_closed: bool,
}

/// Link to a board.
#[derive(Debug)]
pub(in crate::drives::klipper) struct Link {
    wire: Box<dyn Wire>,
    place: Place,
    stop: StopRequest,
    /// True while a gate hears the user, and no wait does.
    is_deaf: bool,
    reader: BlockReader,
    window: Window,
    waiting: Waiting,
    arrivals: VecDeque<Arrival>,
    quiet: Duration,
    /// Number of bytes that came.
    came: u64,
    /// Number of blocks that had failed their checksum at the last confirmation.
    corrupt: u64,
}

impl Link {
    /// Makes the link over a wire to the board at a place. [`Self::connect`] comes next.
    pub(in crate::drives::klipper) fn new(wire: Box<dyn Wire>, place: Place, stop: StopRequest) -> Self {
        Self {
            wire,
            place,
            stop,
            is_deaf: false,
            reader: BlockReader::default(),
            window: Window::new(0),
            waiting: Waiting::default(),
            arrivals: VecDeque::new(),
            quiet: QUIET,
            came: 0,
            corrupt: 0,
        }
    }

    /// Sets the most bytes under way, which the board holds in its buffer: its constant RECEIVE_WINDOW.
    pub(in crate::drives::klipper) fn set_window(&mut self, bytes: usize) {
        self.window.set_bytes_most(bytes);
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
        self.wire.sleep(time);
    }

    /// Returns the clock of a thread that asks for leave while another one has the link.
    pub(in crate::drives::klipper) fn ask_clock(&mut self) -> Box<dyn AskClock> {
        self.wire.ask_clock()
    }

    /// Returns the time of the wire, which a pause of this program holds up.
    pub(in crate::drives::klipper) fn now(&mut self) -> Duration {
        self.wire.now()
    }

    /// Returns the time of the wire's steady clock, by which the board's clock is read.
    pub(in crate::drives::klipper) fn steady_now(&mut self) -> Duration {
        self.wire.steady_now()
    }

    /// Returns the time of the wire's steady clock at an instant.
    pub(in crate::drives::klipper) fn steady_at(&mut self, at: Instant) -> Duration {
        match self.wire.steady_begin() {
            Some(begin) => at.saturating_duration_since(begin),
            None => self.wire.steady_now() + at.saturating_duration_since(Instant::now()),
        }
    }

    /// Returns the number of blocks that wait to be sent.
    pub(in crate::drives::klipper) fn waiting(&self) -> usize {
        self.waiting.contents.len()
    }

    /// Returns the number of blocks that were sent and not confirmed.
    pub(in crate::drives::klipper) fn under_way(&self) -> usize {
        self.window.under_way()
    }

    /// Returns the time by the steady clock at which a block was sent first. `None` if it was not yet, or long ago.
    #[cfg(test)]
    pub(in crate::drives::klipper) fn sent_at(&self, number: u64) -> Option<Duration> {
        self.window.sent_at(number)
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
        let sent = self.window.sent_at(number)?;
        (answer.taken == Some(number)).then_some((sent, answer.at))
    }

    /// Refuses a board that speaks grbl's protocol, before it gets a byte of this one: the sync byte 7Eh lets a grbl
    /// board go on from a hold.
    pub(in crate::drives::klipper) fn refuse_grbl(&mut self) -> Result<(), KlipperError> {
        self.wire.write(grbl_report::QUESTION).map_err(KlipperError::Gone)?;
        let until = self.wire.now() + REPORT;
        let mut heard = Vec::new();
        while heard.len() < HEARD_MOST {
            self.heed()?;
            let left = until.saturating_sub(self.wire.now());
            if left.is_zero() {
                break;
            }
            let mut buffer = [0; 256];
            let count = self.wire.read(&mut buffer, left.min(HEED)).map_err(KlipperError::Gone)?;
            heard.extend_from_slice(buffer.get(..count).unwrap_or_default());
            if grbl_report::is_in(&heard) {
                let Place { port, baud } = self.place.clone();
                return Err(KlipperError::Foreign { port, baud, bytes: heard.len() as u64 });
            }
        }
        Ok(())
    }

    /// Finds the block that the board takes next, and begins there. Nothing that was queued before is sent.
    ///
    /// The board answers any block, and one that it does not expect with the number that it does. The number holds once
    /// the board has taken an empty block of it. So answers to an earlier program mislead nobody.
    pub(in crate::drives::klipper) fn connect(&mut self, limit: Duration) -> Result<(), KlipperError> {
        self.waiting = Waiting::default();
        self.arrivals.clear();
        self.reader = BlockReader::default();
        let (came, began) = (self.came, self.wire.now());
        let (mut next, mut is_told, mut has_answered) = (0, false, false);
        loop {
            let probe = [&[SYNC; BLOCK_MOST], block(next, &[]).as_slice()].concat();
            self.wire.write(&probe).map_err(KlipperError::Gone)?;
            let until = self.wire.now() + FIND_AGAIN;
            while let Some(Block { sequence, .. }) = self.next_block(until)? {
                has_answered = true;
                if is_told && sequence == (next + 1) % 16 {
                    self.window = Window::new(sequence);
                    self.corrupt = self.reader.corrupt();
                    return Ok(());
                }
                if !is_told || sequence != next {
                    (next, is_told) = (sequence, true);
                    break;
                }
                if self.wire.now() >= until {
                    break;
                }
            }
            self.reader.give_up();
            let waited = self.wire.now().saturating_sub(began);
            if waited >= limit {
                return Err(self.not_found(has_answered, self.came - came, waited));
            }
        }
    }

    /// Returns the error of a board that was not found.
    fn not_found(&self, has_answered: bool, bytes: u64, waited: Duration) -> KlipperError {
        let Place { port, baud } = self.place.clone();
        let waited_s = waited.as_secs_f64();
        match (has_answered, bytes) {
            (true, _) => KlipperError::Garbled { waited_s, corrupt: self.reader.corrupt() },
            (false, 0) => KlipperError::Silent { port, baud, waited_s },
            (false, bytes) => KlipperError::Foreign { port, baud, bytes },
        }
    }

    /// Waits for a block until a time, and hears the user meanwhile.
    fn next_block(&mut self, until: Duration) -> Result<Option<Block>, KlipperError> {
        loop {
            self.heed()?;
            if let Some(block) = self.reader.next() {
                return Ok(Some(block));
            }
            let left = until.saturating_sub(self.wire.now());
            if left.is_zero() {
                return Ok(None);
            }
            self.read(left.min(HEED))?;
        }
    }

    /// Queues a command, which the next turns send. Commands share blocks. Returns the number of its block.
    pub(in crate::drives::klipper) fn queue(&mut self, command: &[u8]) -> Result<u64, KlipperError> {
        if command.len() > CONTENT_MOST {
            let (bytes, most) = (command.len(), CONTENT_MOST);
            return Err(MessageError::Long { command: "a command".to_owned(), bytes, most }.into());
        }
        match self.waiting.contents.back_mut() {
            Some(last) if !self.waiting.is_closed && last.len() + command.len() <= CONTENT_MOST => {
                last.extend_from_slice(command);
            }
            _ => {
                self.waiting.contents.push_back(command.to_vec());
                self.waiting.is_closed = false;
            }
        }
        Ok(self.window.next() + self.waiting.contents.len() as u64 - 1)
    }

    /// Queues a command in a block of its own, as a question whose answer is told by the number of the block.
    pub(in crate::drives::klipper) fn queue_alone(&mut self, command: &[u8]) -> Result<u64, KlipperError> {
        self.waiting.is_closed = true;
        let number = self.queue(command)?;
        self.waiting.is_closed = true;
        Ok(number)
    }

    /// Returns the oldest block with content that has come.
    pub(in crate::drives::klipper) fn take(&mut self) -> Option<Arrival> {
        self.arrivals.pop_front()
    }

    /// Sends what is due, and takes in what has come, for as long as `wait` at most. Returns at the first arrival.
    ///
    /// The link is lost only after all input was read.
    pub(in crate::drives::klipper) fn turn(&mut self, wait: Duration) -> Result<(), KlipperError> {
        let until = self.wire.now() + wait;
        self.read_all()?;
        loop {
            self.send()?;
            self.check()?;
            let now = self.wire.now();
            if !self.arrivals.is_empty() || now >= until {
                return Ok(());
            }
            let wakes_at = self.window.wakes_at().map_or(until, |at| at.min(until));
            self.read(wakes_at.saturating_sub(now))?;
            self.read_all()?;
        }
    }

    /// Waits until the board has taken all that was queued. Arrivals are kept.
    pub(in crate::drives::klipper) fn settle(&mut self) -> Result<(), KlipperError> {
        let mut arrivals = VecDeque::new();
        while self.waiting() + self.under_way() > 0 {
            self.heed()?;
            self.turn(HEED)?;
            arrivals.append(&mut self.arrivals);
        }
        self.arrivals = arrivals;
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
        let began = self.wire.now();
        let answered = loop {
            let number = self.queue_alone(&command)?;
            let asked = self.wire.now();
            let mut answered = None;
            while answered.is_none() && (self.under_way() > 0 || self.wire.now() - asked < ASK_AGAIN) {
                self.heed()?;
                self.turn(HEED)?;
                while let Some(arrival) = self.arrivals.pop_front() {
                    answered = answer(self, number, &arrival)?;
                    if answered.is_some() {
                        break;
                    }
                    others.push_back(arrival);
                }
            }
            let waited = self.wire.now().saturating_sub(began);
            match answered {
                Some(answered) => break answered,
                None if waited < self.quiet => {}
                None => {
                    let (question, waited_s) = (question.name().to_owned(), waited.as_secs_f64());
                    return Err(KlipperError::NoAnswer { question, waited_s });
                }
            }
        };
        others.append(&mut self.arrivals);
        self.arrivals = others;
        Ok(answered)
    }

    /// Refuses to go on at rest if the user asked to stop.
    fn heed(&self) -> Result<(), KlipperError> {
        if self.stop.is_made() && !self.is_deaf { Err(KlipperError::Interrupted) } else { Ok(()) }
    }

    /// Takes in what has come, and waits for the first byte until `wait` has passed. Returns true if bytes came.
    fn read(&mut self, wait: Duration) -> Result<bool, KlipperError> {
        let mut buffer = [0; 1024];
        let count = self.wire.read(&mut buffer, wait).map_err(KlipperError::Gone)?;
        self.came += count as u64;
        self.reader.push(buffer.get(..count).unwrap_or_default());
        Ok(count > 0)
    }

    /// Takes in all that has come.
    fn read_all(&mut self) -> Result<(), KlipperError> {
        for _ in 0..READS_MOST {
            if !self.read(Duration::ZERO)? {
                break;
            }
        }
        Ok(())
    }

    /// Takes the blocks that have come. Returns true if the board asks for those under way again.
    fn hear(&mut self, now: Duration, steady: Duration) -> bool {
        let mut asks_again = false;
        while let Some(Block { sequence, content }) = self.reader.next() {
            let before = self.window.under_way();
            let heard = self.window.hear(sequence, content.is_empty(), now);
            if self.window.under_way() < before {
                self.corrupt = self.reader.corrupt();
            }
            asks_again |= heard.asks_again;
            if !content.is_empty() {
                self.arrivals.push_back(Arrival { content, at: steady, taken: heard.taken });
            }
        }
        asks_again
    }

    /// Takes the blocks that have come, then sends those that are due.
    fn send(&mut self) -> Result<(), KlipperError> {
        let (now, steady) = (self.wire.now(), self.wire.steady_now());
        let mut asks_again = self.hear(now, steady);
        if self.window.is_due(now) {
            self.reader.give_up();
            asks_again |= self.hear(now, steady);
        }
        if self.window.under_way() > 0 && (asks_again || self.window.is_due(now)) {
            let bytes = self.window.repeat(now);
            self.wire.write(&bytes).map_err(KlipperError::Gone)?;
        }
        while let Some(content) = self.waiting.contents.front() {
            let Some(bytes) = self.window.send(content, now, steady) else { break };
            self.wire.write(bytes).map_err(KlipperError::Gone)?;
            self.waiting.contents.pop_front();
        }
        Ok(())
    }

    /// Returns the error of a link that is lost.
    fn check(&mut self) -> Result<(), KlipperError> {
        let waited = self.window.waited(self.wire.now());
        if waited < self.quiet {
            return Ok(());
        }
        let waited_s = waited.as_secs_f64();
        let corrupt = self.reader.corrupt() - self.corrupt;
        Err(match (self.window.astray(), corrupt) {
            (Some(told), _) => KlipperError::OutOfStep { waited_s, told },
            (None, 0) => KlipperError::Quiet { waited_s },
            (None, corrupt) => KlipperError::Garbled { waited_s, corrupt },
        })
    }
}
