//! The board, its line, and what befalls them.

use std::collections::VecDeque;

use pump_node::{Axes, Axis, Node, identity};

use super::hardware::{Shared, SimulatedPins, TICK_HZ};
use super::misread::misread;
use crate::onlooker::Onlooker;

/// Time of a byte at 460,800 baud, us, rounded up.
const BYTE_US: u64 = 22;

/// Time of a frame on its way besides that of its bytes, us.
const LATENCY_US: u64 = 500;

/// Time of a frame on its way over a slow line, us. An answer takes twice as long.
const SLOW_US: u64 = 150_000;

type NodeAxes = Axes<'static, SimulatedPins, Shared, 256, 4>;

/// Event of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Event {
    Cut,
    Mend,
    /// The line is slow from now on.
    Slow,
    Reset,
    Estop,
}

/// Board, line and clock.
pub(crate) struct World {
    pub(crate) now_us: u64,
    booted_us: u64,
    number: u64,
    pub(super) hardware: Shared,
    node: Node,
    axes: NodeAxes,
    to_node: VecDeque<(u64, u8)>,
    pub(super) to_host: VecDeque<(u64, u8)>,
    free_us: [u64; 2],
    next_poll_us: u64,
    is_cut: bool,
    latency_us: u64,
    /// Part of the frames that are lost on the way.
    pub(crate) lost: f64,
    /// Part of the frames of which a byte changes on the way.
    pub(crate) corrupted: f64,
    /// Rates of the two ends of the line where they differ, bits a second: the host's and the board's.
    pub(crate) rates: Option<[u32; 2]>,
    pub(crate) random: u64,
    /// Events to come, each with its time.
    pub(crate) events: VecDeque<(u64, Event)>,
    /// Bytes that something else than a node says to each frame.
    pub(crate) foreign: Option<Vec<u8>>,
    /// Threads that ask for leave, each with its number.
    pub(super) askers: Vec<(u64, Asker)>,
    pub(super) next_asker: u64,
    /// Segments on their way to the board, as an onlooker reads them off the line.
    pub(crate) onlooker: Onlooker,
}

/// Thread that asks for leave while another one streams. The board goes on only while all of them wait.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Asker {
    /// It goes on, and time stands.
    Awake,
    /// It waits until this time, us.
    Waits(u64),
}

fn board(number: u64, hardware: &Shared) -> (Node, NodeAxes) {
    let axes = [0, 1, 2, 3].map(|axis| Axis::new(SimulatedPins(hardware.clone(), axis), TICK_HZ));
    // The memory of a board outlives its test.
    let axes = Axes::new(Box::leak(Box::new(axes)), hardware.clone(), TICK_HZ);
    (Node::new(identity::<256, 4>(number, [0, 1, 0], TICK_HZ)), axes)
}

impl World {
    pub(super) fn new(number: u64) -> Self {
        let hardware = Shared::default();
        let (node, axes) = board(number, &hardware);
        Self {
            now_us: 5_000_000,
            booted_us: 4_000_000,
            number,
            hardware,
            node,
            axes,
            to_node: VecDeque::new(),
            to_host: VecDeque::new(),
            free_us: [0; 2],
            next_poll_us: 0,
            is_cut: false,
            latency_us: LATENCY_US,
            lost: 0.0,
            corrupted: 0.0,
            rates: None,
            random: 1,
            events: VecDeque::new(),
            foreign: None,
            askers: Vec::new(),
            next_asker: 0,
            onlooker: Onlooker::default(),
        }
    }

    /// Returns a random part of 1.
    fn part(&mut self) -> f64 {
        // Marsaglia's xorshift, Journal of Statistical Software 8(14), 2003.
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn is_lost(&mut self) -> bool {
        self.part() < self.lost || self.is_cut
    }

    /// Returns bytes as they arrive: one of them may have changed, or all of them are read at another rate.
    fn arriving(&mut self, way: usize, bytes: &[u8]) -> Vec<u8> {
        let mut bytes = match self.rates {
            Some(rates) => misread(bytes, rates[way], rates[1 - way]),
            None => bytes.to_vec(),
        };
        if self.corrupted > 0.0 && self.part() < self.corrupted {
            let place = (self.part() * bytes.len() as f64) as usize;
            let bits = 1 + (self.part() * 255.0) as u8;
            if let Some(byte) = bytes.get_mut(place) {
                *byte ^= bits;
            }
        }
        bytes
    }

    pub(super) fn send(&mut self, way: usize, bytes: &[u8]) {
        let from = self.now_us.max(self.free_us[way]);
        self.free_us[way] = from + bytes.len() as u64 * BYTE_US;
        if self.is_lost() {
            return;
        }
        let bytes = self.arriving(way, bytes);
        let line = if way == 0 { &mut self.to_node } else { &mut self.to_host };
        line.extend((1..).zip(bytes).map(|(n, byte)| (from + self.latency_us + n * BYTE_US, byte)));
    }

    fn befall(&mut self, event: Event) {
        match event {
            Event::Cut => {
                self.is_cut = true;
                self.to_node.clear();
                self.to_host.clear();
            }
            Event::Mend => self.is_cut = false,
            Event::Slow => self.latency_us = SLOW_US,
            Event::Estop => self.hardware.0.lock().unwrap().estop = true,
            Event::Reset => {
                let hardware = &mut *self.hardware.0.lock().unwrap();
                hardware.now = 0;
                hardware.motors.iter_mut().for_each(|motor| motor.levels = None);
                self.booted_us = self.now_us;
                (self.node, self.axes) = board(self.number, &self.hardware);
            }
        }
    }

    /// Goes on to the next event, at `until_us` at the latest.
    pub(super) fn go_on(&mut self, until_us: u64) {
        let timer_us = self.axes.next_alarm().map(|tick| tick + self.booted_us);
        let nexts =
            [timer_us, self.to_node.front().map(|(at, _)| *at), self.events.front().map(|(at, _)| *at)];
        let next = nexts.into_iter().flatten().chain([self.next_poll_us, until_us]).min().unwrap();
        self.now_us = self.now_us.max(next);
        if self.events.front().is_some_and(|(at, _)| *at <= self.now_us) {
            let (_, event) = self.events.pop_front().unwrap();
            self.befall(event);
        }
        let tick = self.now_us - self.booted_us;
        self.hardware.0.lock().unwrap().now = tick;
        if self.axes.next_alarm().is_some_and(|at| at <= tick) {
            let _ = self.axes.on_timer();
            self.now_us = self.now_us.max(self.hardware.0.lock().unwrap().now + self.booted_us);
        }
        while let Some((_, byte)) = self.to_node.front().copied().filter(|(at, _)| *at <= self.now_us) {
            self.to_node.pop_front();
            if let Some(foreign) = &self.foreign {
                if byte == 0 {
                    let bytes = foreign.clone();
                    self.send(1, &bytes);
                }
                continue;
            }
            self.onlooker.sees(byte, self.now_us - self.booted_us);
            if let Some(answer) = self.node.on_byte(byte, self.now_us - self.booted_us, &mut self.axes) {
                self.send(1, answer.bytes());
            }
        }
        if self.now_us >= self.next_poll_us {
            self.next_poll_us = self.now_us + 1000;
            self.node.poll(self.now_us - self.booted_us, &mut self.axes);
        }
    }
}
