//! The trunk to a board: blocks over a wire, which the links of several motors share.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::grbl_report;
use super::link::{Arrival, Place};
use super::window::Window;
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::protocol::{
    BLOCK_MOST, Block, BlockReader, CONTENT_MOST, MessageError, SYNC, block,
};
use crate::drives::wire::{AskClock, Wire};

/// Longest wait at rest before the user is heard.
pub(super) const HEED: Duration = Duration::from_millis(20);

/// Time for which the board is given to answer while it is being found.
const FIND_AGAIN: Duration = Duration::from_millis(100);

/// Time for which a grbl board's report is waited for. It comes within some ms.
const REPORT: Duration = Duration::from_millis(200);

/// Most bytes in which a report is looked for.
const HEARD_MOST: usize = 4096;

/// Most reads of one turn before it sends. A board that never pauses is a fault of its own.
const READS_MOST: usize = 64;

/// Most arrivals that a link leaves. It asks nothing then, and older ones tell it nothing any more.
const ARRIVALS_MOST: usize = 256;

/// Question whether the user has asked to stop, which is an error then.
pub(super) type Heed<'a> = &'a dyn Fn() -> Result<(), KlipperError>;

/// Blocks that wait to be sent.
#[derive(Debug, Default)]
struct Waiting {
    contents: VecDeque<Vec<u8>>,
    /// True if the last block takes no further command.
    is_closed: bool,
}

/// Link of the trunk, with what it has not taken yet.
#[derive(Debug)]
struct Lane {
    number: u64,
    /// True while the motor of the link has met the board.
    is_met: bool,
    arrivals: VecDeque<Arrival>,
}

/// Trunk to a board.
#[derive(Debug)]
pub(super) struct Trunk {
    wire: Box<dyn Wire>,
    reader: BlockReader,
    window: Window,
    waiting: Waiting,
    lanes: Vec<Lane>,
    lanes_before: u64,
    /// Number of times that the board was found.
    pub(super) connections: u64,
    /// Number of bytes that came.
    came: u64,
    /// Number of blocks that had failed their checksum at the last confirmation.
    corrupt: u64,
    /// True once the wire has failed.
    pub(super) is_gone: bool,
}

impl Trunk {
    /// Makes the trunk over a wire.
    pub(super) fn new(wire: Box<dyn Wire>) -> Self {
        Self {
            wire,
            reader: BlockReader::default(),
            window: Window::new(0),
            waiting: Waiting::default(),
            lanes: Vec::new(),
            lanes_before: 0,
            connections: 0,
            came: 0,
            corrupt: 0,
            is_gone: false,
        }
    }

    /// Opens a lane, and returns its number.
    pub(super) fn open(&mut self) -> u64 {
        let number = self.lanes_before;
        self.lanes_before += 1;
        self.lanes.push(Lane { number, is_met: false, arrivals: VecDeque::new() });
        number
    }

    /// Closes a lane.
    pub(super) fn close(&mut self, lane: u64) {
        self.lanes.retain(|other| other.number != lane);
    }

    /// Returns the number of lanes.
    pub(super) fn lanes(&self) -> usize {
        self.lanes.len()
    }

    /// Returns true if the motor of another lane has met the board.
    pub(super) fn is_met_by_others(&self, lane: u64) -> bool {
        self.lanes.iter().any(|other| other.number != lane && other.is_met)
    }

    /// Notes whether the motor of a lane has met the board.
    pub(super) fn note_met(&mut self, lane: u64, is_met: bool) {
        if let Some(lane) = self.lane(lane) {
            lane.is_met = is_met;
        }
    }

    fn lane(&mut self, lane: u64) -> Option<&mut Lane> {
        self.lanes.iter_mut().find(|other| other.number == lane)
    }

    /// Returns the oldest arrival that a lane has not taken.
    pub(super) fn take(&mut self, lane: u64) -> Option<Arrival> {
        self.lane(lane)?.arrivals.pop_front()
    }

    /// Returns true if there is an arrival that a lane has not taken.
    pub(super) fn has_arrivals(&self, lane: u64) -> bool {
        self.lanes.iter().any(|other| other.number == lane && !other.arrivals.is_empty())
    }

    /// Sets the most bytes under way.
    pub(super) fn set_window(&mut self, bytes: usize) {
        self.window.set_bytes_most(bytes);
    }

    pub(super) fn now(&mut self) -> Duration {
        self.wire.now()
    }

    pub(super) fn steady_now(&mut self) -> Duration {
        self.wire.steady_now()
    }

    /// Returns the time of the wire's steady clock at an instant.
    pub(super) fn steady_at(&mut self, at: Instant) -> Duration {
        match self.wire.steady_begin() {
            Some(begin) => at.saturating_duration_since(begin),
            None => self.wire.steady_now() + at.saturating_duration_since(Instant::now()),
        }
    }

    pub(super) fn sleep(&mut self, time: Duration) {
        self.wire.sleep(time);
    }

    pub(super) fn ask_clock(&mut self) -> Box<dyn AskClock> {
        self.wire.ask_clock()
    }

    /// Returns the number of blocks that wait to be sent.
    pub(super) fn waiting(&self) -> usize {
        self.waiting.contents.len()
    }

    /// Returns the number of blocks that were sent and not confirmed.
    #[cfg(test)]
    pub(super) fn under_way(&self) -> usize {
        self.window.under_way()
    }

    /// Returns the number of the last block that was queued.
    pub(super) fn last(&self) -> u64 {
        self.window.next() + self.waiting.contents.len() as u64 - 1
    }

    /// Gives arrivals back that a lane has taken, before those that have come since.
    pub(super) fn give_back(&mut self, lane: u64, arrivals: VecDeque<Arrival>) {
        if let Some(lane) = self.lane(lane) {
            let mut since = std::mem::replace(&mut lane.arrivals, arrivals);
            lane.arrivals.append(&mut since);
        }
    }

    /// Returns true if the board has taken the block of this number.
    pub(super) fn has_taken(&self, number: u64) -> bool {
        number + (self.window.under_way() as u64) < self.window.next()
    }

    /// Returns the time by the steady clock at which a block was sent first. `None` if it was not yet, or long ago.
    pub(super) fn sent_at(&self, number: u64) -> Option<Duration> {
        self.window.sent_at(number)
    }

    /// Refuses a board that speaks grbl's protocol, before it gets a byte of this one: the sync byte 7Eh lets a grbl
    /// board go on from a hold.
    pub(super) fn refuse_grbl(&mut self, place: &Place, heed: Heed<'_>) -> Result<(), KlipperError> {
        self.write(grbl_report::QUESTION)?;
        let until = self.wire.now() + REPORT;
        let mut heard = Vec::new();
        while heard.len() < HEARD_MOST {
            heed()?;
            let left = until.saturating_sub(self.wire.now());
            if left.is_zero() {
                break;
            }
            let mut buffer = [0; 256];
            let count = self.read_wire(&mut buffer, left.min(HEED))?;
            heard.extend_from_slice(buffer.get(..count).unwrap_or_default());
            if grbl_report::is_in(&heard) {
                let Place { port, baud } = place.clone();
                return Err(KlipperError::Foreign { port, baud, bytes: heard.len() as u64 });
            }
        }
        Ok(())
    }

    /// Finds the block that the board takes next, and begins there. Nothing that was queued before is sent.
    ///
    /// The board answers any block, and one that it does not expect with the number that it does. The number holds once
    /// the board has taken an empty block of it. So answers to an earlier program mislead nobody.
    pub(super) fn connect(
        &mut self,
        limit: Duration,
        place: &Place,
        heed: Heed<'_>,
    ) -> Result<(), KlipperError> {
        self.waiting = Waiting::default();
        self.lanes.iter_mut().for_each(|lane| lane.arrivals.clear());
        self.connections += 1;
        self.reader = BlockReader::default();
        let (came, began) = (self.came, self.wire.now());
        let (mut next, mut is_told, mut has_answered) = (0, false, false);
        loop {
            let probe = [&[SYNC; BLOCK_MOST], block(next, &[]).as_slice()].concat();
            self.write(&probe)?;
            let until = self.wire.now() + FIND_AGAIN;
            while let Some(Block { sequence, .. }) = self.next_block(until, heed)? {
                has_answered = true;
                if is_told && sequence == (next + 1) % 16 {
                    self.window = self.window.anew(sequence);
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
                return Err(self.not_found(place, (has_answered, self.came - came), waited));
            }
        }
    }

    /// Returns the error of a board that was not found.
    fn not_found(&self, place: &Place, (has_answered, bytes): (bool, u64), waited: Duration) -> KlipperError {
        let Place { port, baud } = place.clone();
        let waited_s = waited.as_secs_f64();
        match (has_answered, bytes) {
            (true, _) => KlipperError::Garbled { waited_s, corrupt: self.reader.corrupt() },
            (false, 0) => KlipperError::Silent { port, baud, waited_s },
            (false, bytes) => KlipperError::Foreign { port, baud, bytes },
        }
    }

    /// Waits for a block until a time, and hears the user meanwhile.
    fn next_block(&mut self, until: Duration, heed: Heed<'_>) -> Result<Option<Block>, KlipperError> {
        loop {
            heed()?;
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
    pub(super) fn queue(&mut self, command: &[u8]) -> Result<u64, KlipperError> {
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
        Ok(self.last())
    }

    /// Queues commands that no other link may come between. Returns the number of the first one's block.
    pub(super) fn queue_all(&mut self, commands: &[Vec<u8>]) -> Result<u64, KlipperError> {
        let mut first = None;
        for command in commands {
            let number = self.queue(command)?;
            first.get_or_insert(number);
        }
        Ok(first.unwrap_or(self.last()))
    }

    /// Queues a command in a block of its own, as a question whose answer is told by the number of the block.
    pub(super) fn queue_alone(&mut self, command: &[u8]) -> Result<u64, KlipperError> {
        self.waiting.is_closed = true;
        let number = self.queue(command)?;
        self.waiting.is_closed = true;
        Ok(number)
    }

    /// Sends what is due, and takes in what has come, until a time at most. Returns at the first arrival for a lane.
    ///
    /// The link is lost only after all input was read.
    pub(super) fn turn(&mut self, lane: u64, until: Duration, quiet: Duration) -> Result<(), KlipperError> {
        self.read_all()?;
        loop {
            self.send()?;
            self.check(quiet)?;
            let now = self.wire.now();
            if self.has_arrivals(lane) || now >= until {
                return Ok(());
            }
            let wakes_at = self.window.wakes_at().map_or(until, |at| at.min(until));
            self.read(wakes_at.saturating_sub(now))?;
            self.read_all()?;
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), KlipperError> {
        let written = self.wire.write(bytes);
        self.is_gone |= written.is_err();
        written.map_err(KlipperError::Gone)
    }

    fn read_wire(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, KlipperError> {
        let count = self.wire.read(buffer, wait);
        self.is_gone |= count.is_err();
        count.map_err(KlipperError::Gone)
    }

    /// Takes in what has come, and waits for the first byte until `wait` has passed. Returns true if bytes came.
    fn read(&mut self, wait: Duration) -> Result<bool, KlipperError> {
        let mut buffer = [0; 1024];
        let count = self.read_wire(&mut buffer, wait)?;
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
                self.deliver(&Arrival { content, at: steady, taken: heard.taken });
            }
        }
        asks_again
    }

    /// Has each lane know of an arrival. A message tells by its object whom it concerns.
    fn deliver(&mut self, arrival: &Arrival) {
        for lane in &mut self.lanes {
            if lane.arrivals.len() == ARRIVALS_MOST {
                lane.arrivals.pop_front();
            }
            lane.arrivals.push_back(arrival.clone());
        }
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
            self.write(&bytes)?;
        }
        while let Some(content) = self.waiting.contents.front() {
            let Some(bytes) = self.window.send(content, now, steady) else { break };
            let written = self.wire.write(bytes);
            self.is_gone |= written.is_err();
            written.map_err(KlipperError::Gone)?;
            self.waiting.contents.pop_front();
        }
        Ok(())
    }

    /// Returns the error of a link that is lost.
    fn check(&mut self, quiet: Duration) -> Result<(), KlipperError> {
        let waited = self.window.waited(self.wire.now());
        if waited < quiet {
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
