//! The board, its clock and its line, as they run.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::sync::Mutex;
use std::time::Duration;

use super::board::Board;
use super::clock::Clock;
use super::dictionary::Reason;
use super::line::Line;
use super::noise::NoisyLine;
use super::options::{Character, SOCKETS};
use super::{Hand, Shared, lock};

/// Longest time between two looks at the line.
const LOOK: Duration = Duration::from_millis(1);

/// Lateness of a look beyond which the bytes that came meanwhile count as heard at the look before. Only the computer's
/// load makes a look so late, and a real board would have heard them in time.
const LATE: Duration = Duration::from_millis(5);

/// Bits of a byte on a line.
const BITS: u64 = 10;

/// Simulation of a board.
pub(super) struct Simulation {
    board: Board,
    clock: Clock,
    line: Line,
    /// Ticks of a byte on the line.
    byte: u64,
    noise: [NoisyLine; 2],
    /// Bytes on their way to the board and from it, each with the tick at which it is there.
    inward: VecDeque<(u64, u8)>,
    outward: VecDeque<(u64, u8)>,
    record: Option<BufWriter<File>>,
    character: Character,
    is_pulled: bool,
}

impl Simulation {
    /// Switches a board on at the end of a line.
    pub(super) fn new(character: Character, line: Line) -> std::io::Result<Self> {
        let clock = Clock::new(character.hz, character.drift_ppm, character.first_tick);
        let byte =
            if character.baud == 0 { 0 } else { BITS * u64::from(character.hz) / u64::from(character.baud) };
        let record = character.record.as_ref().map(File::create).transpose()?.map(BufWriter::new);
        Ok(Self {
            board: Board::new(character.clone(), clock.now()),
            clock,
            line,
            byte,
            noise: [1, 2].map(|salt| NoisyLine::new(character.noise, salt)),
            inward: VecDeque::new(),
            outward: VecDeque::new(),
            record,
            character,
            is_pulled: false,
        })
    }

    /// Runs until the shared state says that it is over.
    pub(super) fn run(&mut self, shared: &Mutex<Shared>) {
        loop {
            let next = self.next().saturating_sub(self.clock.now());
            self.line.wait(self.clock.time(next).min(LOOK));
            let before = self.board.now;
            let (bytes, now) = (self.line.read(), self.clock.now());
            let is_late = now.saturating_sub(before) > self.clock.ticks(LATE);
            if !self.is_pulled {
                let bytes = self.noise[0].carry(&bytes);
                queue(&mut self.inward, if is_late { before } else { now }, self.byte, &bytes);
            }
            self.advance(now, is_late);
            // Nobody hears an answer of the board before its truth is out.
            self.publish(&mut lock(shared));
            self.write(now);
            let mut shared = lock(shared);
            for hand in std::mem::take(&mut shared.hands) {
                shared.answers.push(self.touch(&hand));
                self.publish(&mut shared);
            }
            if shared.truth.over {
                return;
            }
        }
    }

    /// Returns the tick at which something happens next.
    fn next(&self) -> u64 {
        let bytes = [&self.inward, &self.outward].map(|way| way.front().map_or(u64::MAX, |(at, _)| *at));
        bytes.into_iter().fold(self.board.next(), u64::min)
    }

    /// Lets everything happen up to tick `now`, in its order.
    fn advance(&mut self, now: u64, is_late: bool) {
        while let Some((at, byte)) = self.inward.front().copied().filter(|(at, _)| *at <= now) {
            self.inward.pop_front();
            self.board.advance(at);
            // A late board has not read its clock before the host asked.
            self.board.read = if is_late { now } else { self.board.now };
            self.board.hear(byte);
            self.answer();
            if std::mem::take(&mut self.board.wants_reset) {
                self.reset();
                return;
            }
        }
        self.board.advance(now);
        self.answer();
    }

    /// Resets the processor, whose clock begins anew. The bytes on their way are lost.
    fn reset(&mut self) {
        self.inward.clear();
        self.clock = Clock::new(self.character.hz, self.character.drift_ppm, 0);
        let now = self.clock.now();
        let off = Board::new(self.character.clone(), now);
        self.board = std::mem::replace(&mut self.board, off).reset(now);
        self.outward.clear();
        self.answer();
    }

    /// Puts what the board says on the line.
    fn answer(&mut self) {
        let bytes = std::mem::take(&mut self.board.outgoing);
        if !self.is_pulled {
            let bytes = self.noise[1].carry(&bytes);
            queue(&mut self.outward, self.board.now, self.byte, &bytes);
        }
    }

    /// Sends the bytes that are through.
    fn write(&mut self, now: u64) {
        let through = self.outward.partition_point(|(at, _)| *at <= now);
        let bytes: Vec<u8> = self.outward.drain(..through).map(|(_, byte)| byte).collect();
        if !bytes.is_empty() {
            self.line.write(&bytes);
        }
        let made = std::mem::take(&mut self.board.made);
        let Some(record) = &mut self.record else { return };
        for step in &made {
            let way = if step.is_forward { 1 } else { -1 };
            let name = match step.socket {
                Ok(socket) => SOCKETS.get(socket).map_or("", |socket| socket.name).to_owned(),
                Err(pin) => format!("pin{pin}"),
            };
            let _ = writeln!(record, "{name} {} {way}", step.at);
        }
        if !made.is_empty() {
            let _ = record.flush();
        }
    }

    /// Does what a person's hand does at the board.
    fn touch(&mut self, hand: &Hand) -> Result<(), String> {
        match hand {
            Hand::Reset => self.reset(),
            Hand::Pull => {
                self.is_pulled = true;
                self.inward.clear();
                self.outward.clear();
            }
            Hand::Plug => self.is_pulled = false,
            Hand::Supply(is_there) => self.board.supply(*is_there),
            Hand::Shutdown => self.board.shut_down(Reason::TooClose),
            Hand::Jump(ticks) => self.clock.jump(*ticks),
            Hand::Fault { socket, fault, is_there } => {
                let driver =
                    self.board.drivers.get_mut(*socket).ok_or("that socket has no driver with a line")?;
                driver.set_fault(fault, *is_there)?;
            }
        }
        Ok(())
    }

    /// Publishes the truth about the board.
    fn publish(&self, shared: &mut Shared) {
        let (truth, board) = (&mut shared.truth, &self.board);
        (truth.steps, truth.stray, truth.asked) = (board.steps, board.stray, board.asked);
        truth.moving = board.is_moving();
        truth.configured = board.is_configured();
        truth.most_used = board.most_used;
        (truth.now, truth.clock) = (board.now, Some(self.clock));
        truth.shutdown = board.shutdown.map(Reason::words);
        truth.drivers =
            board.drivers.iter().map(|driver| [0x00, 0x10, 0x6c].map(|n| driver.register(n))).collect();
    }
}

/// Puts bytes on a line, one after the other from tick `from` on.
fn queue(way: &mut VecDeque<(u64, u8)>, from: u64, byte_ticks: u64, bytes: &[u8]) {
    let mut at = way.back().map_or(from, |(at, _)| from.max(*at));
    for byte in bytes {
        at += byte_ticks;
        way.push_back((at, *byte));
    }
}
