//! A board in memory behind a bad line, in virtual time. It has a codec of its own.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::drives::wire::Wire;

/// Random numbers (Steele, Lea and Flood, SplitMix64, 2014).
#[derive(Debug, Clone)]
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    pub(super) fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    /// Returns true at a rate in a million.
    fn at(&mut self, rate: u64) -> bool {
        self.below(1_000_000) < rate
    }
}

/// Faults of a line, and its delays.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Faults {
    /// Rate at which a byte begins a fault, in a million.
    pub(super) byte: u64,
    /// Rate at which all that is written at once comes twice, in a million.
    pub(super) double: u64,
    /// Longest delay of what is written at once, us.
    pub(super) delay_us: u64,
    /// Time from which on nothing passes, us.
    pub(super) dead_from_us: Option<u64>,
}

/// Fewest bytes between two faults. The checksum finds every burst of 16 bits, but one of 65,536 blocks with two bursts
/// passes it: that is a limit of the protocol, and no test of the link.
const APART: u64 = 70;

/// Time of a byte at 250,000 baud, us.
const BYTE_US: u64 = 40;

/// One direction of a line. Bytes keep their order.
#[derive(Debug)]
struct Line {
    bytes: VecDeque<(u64, u8)>,
    random: Random,
    faults: Faults,
    /// Bytes since the last fault.
    since: u64,
    /// Bytes that are still to be lost.
    losing: u64,
    last_us: u64,
}

impl Line {
    fn new(random: Random, faults: Faults) -> Self {
        Self { bytes: VecDeque::new(), random, faults, since: 0, losing: 0, last_us: 0 }
    }

    fn write(&mut self, bytes: &[u8], now_us: u64) {
        let copies = if self.random.at(self.faults.double) { 2 } else { 1 };
        let delay = self.random.below(self.faults.delay_us + 1);
        self.last_us = self.last_us.max(now_us + delay);
        for byte in bytes.repeat(copies) {
            self.last_us += BYTE_US;
            if self.faults.dead_from_us.is_some_and(|dead| now_us >= dead) {
                continue;
            }
            self.since += 1;
            if self.losing > 0 {
                self.losing -= 1;
                continue;
            }
            if self.since < APART || !self.random.at(self.faults.byte) {
                self.bytes.push_back((self.last_us, byte));
                continue;
            }
            self.since = 0;
            match self.random.below(5) {
                0 => {}
                1 => self.losing = self.random.below(40),
                2 => self.bytes.extend([(self.last_us, byte); 2]),
                3 => self.bytes.push_back((self.last_us, byte ^ (1 + self.random.below(255)) as u8)),
                _ => {
                    self.last_us += self.random.below(60_000);
                    self.bytes.push_back((self.last_us, byte));
                }
            }
        }
    }

    fn take(&mut self, now_us: u64) -> Option<u8> {
        match self.bytes.front() {
            Some((at, byte)) if *at <= now_us => {
                let byte = *byte;
                self.bytes.pop_front();
                Some(byte)
            }
            _ => None,
        }
    }
}

/// Board that takes blocks as `docs/Protocol.md` says. Each command of a test is its length, then its bytes.
#[derive(Debug)]
pub(super) struct Board {
    bytes: Vec<u8>,
    pub(super) next: u8,
    is_lost: bool,
    /// Commands that were carried out, without their lengths.
    pub(super) done: Vec<Vec<u8>>,
    /// Dictionary that the board tells.
    pub(super) dictionary: Vec<u8>,
}

fn framed(sequence: u8, content: &[u8]) -> Vec<u8> {
    let mut bytes = vec![content.len() as u8 + 5, 0x10 | sequence];
    bytes.extend(content);
    let mut sum = 0xffff_u16;
    for bit in bytes.iter().flat_map(|byte| (0..8).map(move |bit| u16::from(byte >> bit & 1))) {
        sum = (sum >> 1) ^ (0x8408 * ((sum ^ bit) & 1));
    }
    bytes.extend([(sum >> 8) as u8, sum as u8, 0x7e]);
    bytes
}

impl Board {
    /// Takes a byte, and returns the bytes of its answers.
    fn take(&mut self, byte: u8) -> Vec<u8> {
        self.bytes.push(byte);
        let mut answers = Vec::new();
        loop {
            if self.is_lost {
                let Some(end) = self.bytes.iter().position(|byte| *byte == 0x7e) else {
                    self.bytes.clear();
                    return answers;
                };
                self.bytes.drain(..=end);
                self.is_lost = false;
                answers.extend(framed(self.next, &[]));
            }
            match self.bytes.as_slice() {
                [] => return answers,
                [0x7e, ..] => _ = self.bytes.remove(0),
                [length, rest @ ..] => {
                    let length = usize::from(*length);
                    let is_header = rest.first().is_none_or(|byte| byte & 0xf0 == 0x10);
                    if !(5..=64).contains(&length) || !is_header {
                        self.is_lost = true;
                    } else if self.bytes.len() < length {
                        return answers;
                    } else if self.bytes[..length] == framed(self.bytes[1] & 0xf, &self.bytes[2..length - 3])
                    {
                        let block: Vec<u8> = self.bytes.drain(..length).collect();
                        if block[1] & 0xf == self.next {
                            self.next = (self.next + 1) & 0xf;
                            answers.extend(self.carry_out(&block[2..length - 3]));
                        }
                        answers.extend(framed(self.next, &[]));
                    } else {
                        self.is_lost = true;
                    }
                }
            }
        }
    }

    fn carry_out(&mut self, mut content: &[u8]) -> Vec<u8> {
        let mut answers = Vec::new();
        if let [1, place @ .., count] = content
            && !self.dictionary.is_empty()
        {
            // `identify`: a place of one or two bytes, and a count.
            let at = place.iter().fold(0, |at, byte| at << 7 | usize::from(byte & 0x7f));
            let rest = self.dictionary.get(at..).unwrap_or_default();
            let piece = &rest[..rest.len().min(usize::from(*count))];
            return framed(self.next, &[&[0], place, &[piece.len() as u8], piece].concat());
        }
        while let [length, rest @ ..] = content {
            let (command, rest) = rest.split_at(usize::from(length & 0x3f));
            self.done.push(command.to_vec());
            if length & 0x40 != 0 {
                answers.extend(framed(self.next, command));
            }
            content = rest;
        }
        answers
    }
}

/// A line each way, and the board at its end.
#[derive(Debug)]
pub(super) struct World {
    pub(super) now_us: u64,
    there: Line,
    back: Line,
    pub(super) board: Board,
}

impl World {
    pub(super) fn new(seed: u64, there: Faults, back: Faults, next: u8) -> Self {
        let mut random = Random(seed);
        let (there, back) = (Line::new(Random(random.next()), there), Line::new(Random(random.next()), back));
        let (bytes, is_lost, done, dictionary) = (Vec::new(), false, Vec::new(), Vec::new());
        Self { now_us: 0, there, back, board: Board { bytes, next, is_lost, done, dictionary } }
    }

    /// Writes to the program, as another device at the port does.
    pub(super) fn say(&mut self, bytes: &[u8]) {
        self.back.write(bytes, self.now_us);
    }

    fn run(&mut self, until_us: u64) {
        while let Some((at, _)) = self.there.bytes.front().copied()
            && at <= until_us
            && let Some(byte) = self.there.take(at)
        {
            let answers = self.board.take(byte);
            if !answers.is_empty() {
                self.back.write(&answers, at);
            }
        }
        self.now_us = until_us;
    }
}

/// Wire to the board of a world.
#[derive(Debug, Clone)]
pub(super) struct PeerWire(pub(super) Arc<Mutex<World>>);

impl Wire for PeerWire {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        let mut world = self.0.lock().unwrap();
        // A wait of less than a microsecond passes too.
        let until = world.now_us + wait.as_nanos().div_ceil(1000) as u64;
        loop {
            let now = world.now_us;
            world.run(now);
            let mut count = 0;
            while count < buffer.len()
                && let Some(byte) = world.back.take(now)
            {
                buffer[count] = byte;
                count += 1;
            }
            if count > 0 || now >= until {
                return Ok(count);
            }
            world.run((now + 500).min(until));
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut world = self.0.lock().unwrap();
        let now = world.now_us;
        world.there.write(bytes, now);
        Ok(())
    }

    fn now(&mut self) -> Duration {
        Duration::from_micros(self.0.lock().unwrap().now_us)
    }

    fn sleep(&mut self, time: Duration) {
        let mut world = self.0.lock().unwrap();
        let until = world.now_us + time.as_micros() as u64;
        world.run(until);
    }
}
