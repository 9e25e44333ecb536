//! A board in software at the end of a line, on one clock.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::time::Duration;

use crate::onlooker::Onlooker;
use pump_bench::drives::wire::{AskClock, Wire};
use pump_node::{Axes, Axis, Board, Edge, Levels, Node, Pins, identity};

/// Ticks per second of the board's timer.
pub(crate) const TICK_HZ: u32 = 1_000_000;

/// Time of a byte at 460,800 baud, us, rounded up.
const BYTE_US: u64 = 22;

/// Time of a frame on its way besides that of its bytes, us.
const LATENCY_US: u64 = 500;

type NodeAxes = Axes<'static, SimulatedPins, Shared, 256, 4>;

/// Pins of an axis, and the motor behind them, which keeps its place through a reset of the board.
#[derive(Debug, Clone, Default)]
pub(crate) struct Motor {
    levels: Option<Levels>,
    /// Steps that the motor has made, signed.
    pub(crate) count: i64,
    /// Ticks at which the step pin rose.
    pub(crate) rises: Vec<u64>,
    /// Rises while the motor has no current.
    pub(crate) stray: u32,
}

#[derive(Debug, Default)]
pub(crate) struct Hardware {
    now: u64,
    pub(crate) estop: bool,
    /// Count of the motor at which the index sensor becomes active.
    pub(crate) index_at: Option<i64>,
    pub(crate) motors: [Motor; 4],
}

#[derive(Debug, Clone, Default)]
struct Shared(Arc<Mutex<Hardware>>);

impl Board for Shared {
    fn now(&mut self) -> u64 {
        self.0.lock().unwrap().now
    }

    fn wait_until(&mut self, tick: u64) {
        let now = &mut self.0.lock().unwrap().now;
        *now = tick.max(*now);
    }

    fn set_steps(&mut self, edge: Edge) {
        for axis in 0..4 {
            for (pins, high) in [(edge.high, true), (edge.low, false)] {
                if pins & 1 << axis != 0 {
                    SimulatedPins(self.clone(), axis).change(|levels| levels.step = high);
                }
            }
        }
    }

    fn estop_is_pressed(&mut self) -> bool {
        self.0.lock().unwrap().estop
    }
}

#[derive(Debug)]
struct SimulatedPins(Shared, usize);

impl SimulatedPins {
    fn change(&mut self, change: impl FnOnce(&mut Levels)) {
        let hardware = &mut *self.0.0.lock().unwrap();
        let motor = &mut hardware.motors[self.1];
        let levels = motor.levels.as_mut().unwrap();
        let before = *levels;
        change(levels);
        if levels.step && !before.step {
            // Enable is active low, and a high direction pin is forward. The emergency stop cuts enable.
            motor.stray += u32::from(levels.enable || hardware.estop);
            motor.count += if levels.direction { 1 } else { -1 };
            motor.rises.push(hardware.now);
        }
    }
}

impl Pins for SimulatedPins {
    fn make_outputs(&mut self, levels: Levels) {
        self.0.0.lock().unwrap().motors[self.1].levels = Some(levels);
    }

    fn step_pin(&self) -> u32 {
        1 << self.1
    }

    fn set_direction(&mut self, high: bool) {
        self.change(|levels| levels.direction = high);
    }

    fn set_enable(&mut self, high: bool) {
        self.change(|levels| levels.enable = high);
    }

    fn index_is_high(&mut self) -> bool {
        let hardware = self.0.0.lock().unwrap();
        hardware.index_at.is_some_and(|at| hardware.motors[self.1].count >= at)
    }

    fn driver_fault_is_high(&mut self) -> bool {
        true
    }
}

/// Event of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Event {
    Cut,
    Mend,
    Reset,
    Estop,
}

/// Board, line and clock.
pub(crate) struct World {
    pub(crate) now_us: u64,
    booted_us: u64,
    number: u64,
    hardware: Shared,
    node: Node,
    axes: NodeAxes,
    to_node: VecDeque<(u64, u8)>,
    to_host: VecDeque<(u64, u8)>,
    free_us: [u64; 2],
    next_poll_us: u64,
    is_cut: bool,
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
    askers: Vec<(u64, Asker)>,
    next_asker: u64,
    /// Segments on their way to the board, as an onlooker reads them off the line.
    pub(crate) onlooker: Onlooker,
}

/// Thread that asks for leave while another one streams. The board goes on only while all of them wait.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Asker {
    /// It goes on, and time stands.
    Awake,
    /// It waits until this time, us.
    Waits(u64),
}

/// Returns the bytes that a serial port at `read_baud` reads where another one sends these at `sent_baud`: a start bit,
/// eight bits from the lowest, and a stop bit. The port looks at the middle of each bit, counted from the edge of the
/// start bit, and drops a byte without its stop bit.
fn misread(bytes: &[u8], sent_baud: u32, read_baud: u32) -> Vec<u8> {
    let bits_of =
        |byte: &u8| (0..10).map(|n| (0x200 | u16::from(*byte) << 1) >> n & 1 == 1).collect::<Vec<_>>();
    let levels: Vec<bool> = bytes.iter().flat_map(bits_of).collect();
    let is_high = |time_s: f64| levels.get((time_s * f64::from(sent_baud)) as usize).copied().unwrap_or(true);
    let (ends_s, bit_s) = (levels.len() as f64 / f64::from(sent_baud), 1.0 / f64::from(read_baud));
    // The port looks for a start bit 16 times a bit.
    let (mut at_s, look_s) = (0.0, bit_s / 16.0);
    let mut read = Vec::new();
    while at_s < ends_s {
        if is_high(at_s) {
            at_s += look_s;
            continue;
        }
        let byte =
            (0..8).fold(0, |byte, n| byte | u8::from(is_high(at_s + (1.5 + f64::from(n)) * bit_s)) << n);
        at_s += 9.5 * bit_s;
        if is_high(at_s) {
            read.push(byte);
        } else {
            while !is_high(at_s) {
                at_s += look_s;
            }
        }
    }
    read
}

fn board(number: u64, hardware: &Shared) -> (Node, NodeAxes) {
    let axes = [0, 1, 2, 3].map(|axis| Axis::new(SimulatedPins(hardware.clone(), axis), TICK_HZ));
    // The memory of a board outlives its test.
    let axes = Axes::new(Box::leak(Box::new(axes)), hardware.clone(), TICK_HZ);
    (Node::new(identity::<256, 4>(number, [0, 1, 0], TICK_HZ)), axes)
}

impl World {
    fn new(number: u64) -> Self {
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

    fn send(&mut self, way: usize, bytes: &[u8]) {
        let from = self.now_us.max(self.free_us[way]);
        self.free_us[way] = from + bytes.len() as u64 * BYTE_US;
        if self.is_lost() {
            return;
        }
        let bytes = self.arriving(way, bytes);
        let line = if way == 0 { &mut self.to_node } else { &mut self.to_host };
        line.extend((1..).zip(bytes).map(|(n, byte)| (from + LATENCY_US + n * BYTE_US, byte)));
    }

    fn befall(&mut self, event: Event) {
        match event {
            Event::Cut => {
                self.is_cut = true;
                self.to_node.clear();
                self.to_host.clear();
            }
            Event::Mend => self.is_cut = false,
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
    fn go_on(&mut self, until_us: u64) {
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

/// World that a test and a drive share.
#[derive(Clone)]
pub(crate) struct SharedWorld(pub(crate) Arc<Mutex<World>>, Arc<Condvar>);

impl std::fmt::Debug for SharedWorld {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.write_str("SharedWorld")
    }
}

impl SharedWorld {
    pub(crate) fn new() -> Self {
        Self::of_board(0xb0a2d)
    }

    pub(crate) fn of_board(number: u64) -> Self {
        Self(Arc::new(Mutex::new(World::new(number))), Arc::default())
    }

    pub(crate) fn hardware<T>(&self, look: impl FnOnce(&mut Hardware) -> T) -> T {
        let hardware = self.0.lock().unwrap().hardware.clone();
        look(&mut hardware.0.lock().unwrap())
    }

    /// Returns the steps that the motor of axis X has made.
    pub(crate) fn count(&self) -> i64 {
        self.hardware(|hardware| hardware.motors[0].count)
    }

    pub(crate) fn rises(&self) -> Vec<u64> {
        self.hardware(|hardware| hardware.motors[0].rises.clone())
    }

    pub(crate) fn now_us(&self) -> u64 {
        self.0.lock().unwrap().now_us
    }

    /// Has something happen so many ms from now.
    pub(crate) fn plan(&self, in_ms: u64, event: Event) {
        let mut world = self.0.lock().unwrap();
        let at = world.now_us + in_ms * 1000;
        world.events.push_back((at, event));
    }

    /// Lets time pass without a host.
    pub(crate) fn pass(&self, ms: u64) {
        let mut world = self.0.lock().unwrap();
        let until = world.now_us + ms * 1000;
        while world.now_us < until {
            world.go_on(until);
        }
        world.to_host.clear();
    }
}

impl SharedWorld {
    /// Returns the world once the threads that ask for leave wait.
    fn alone(&self) -> MutexGuard<'_, World> {
        let world = self.0.lock().unwrap();
        let works = |world: &mut World| world.askers.iter().any(|(_, asker)| *asker == Asker::Awake);
        self.1.wait_while(world, works).unwrap()
    }

    /// Has a thread that asks for leave wait. Returns false if the other thread has ended.
    fn wait(&self, number: u64, time: Duration) -> bool {
        let mut world = self.0.lock().unwrap();
        let at = world.now_us + time.as_micros() as u64;
        let Some((_, asker)) = world.askers.iter_mut().find(|(n, _)| *n == number) else { return false };
        *asker = Asker::Waits(at);
        self.1.notify_all();
        let waits =
            |world: &mut World| world.askers.iter().any(|(n, asker)| *n == number && *asker != Asker::Awake);
        let world = self.1.wait_while(world, waits).unwrap();
        world.askers.iter().any(|(n, _)| *n == number)
    }

    /// Has the only thread that asks for leave wait. Returns false if the other thread has ended.
    pub(crate) fn hold_up(&self, time: Duration) -> bool {
        let first = self.0.lock().unwrap().askers.first().map(|(number, _)| *number);
        first.is_some_and(|number| self.wait(number, time))
    }
}

/// Clock of a thread that asks for leave.
#[derive(Debug)]
struct VirtualClock(SharedWorld, u64);

impl AskClock for VirtualClock {
    fn wait(&self, time: Duration) -> bool {
        self.0.wait(self.1, time)
    }

    fn end(&self) {
        self.0.0.lock().unwrap().askers.retain(|(number, _)| *number != self.1);
        self.0.1.notify_all();
    }
}

impl Wire for SharedWorld {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        let mut world = self.alone();
        // A look at the line takes time, too.
        let until = world.now_us + (wait.as_micros() as u64).max(1);
        loop {
            let now = world.now_us;
            let due = |asker: &Asker| matches!(asker, Asker::Waits(at) if *at <= now);
            // One at a time, so that a test is the same in every run.
            if let Some((_, asker)) = world.askers.iter_mut().find(|(_, asker)| due(asker)) {
                *asker = Asker::Awake;
                self.1.notify_all();
                drop(world);
                world = self.alone();
                continue;
            }
            let now = world.now_us;
            let here = world.to_host.iter().take(buffer.len()).take_while(|(at, _)| *at <= now).count();
            if here > 0 {
                buffer.iter_mut().zip(world.to_host.drain(..here)).for_each(|(to, (_, byte))| *to = byte);
                return Ok(here);
            }
            if now >= until {
                return Ok(0);
            }
            let arrives = world.to_host.front().map_or(until, |(at, _)| *at);
            let asks = world.askers.iter().map(|(_, asker)| match asker {
                Asker::Waits(at) => *at,
                Asker::Awake => now,
            });
            let asks = asks.min().unwrap_or(until);
            world.go_on(until.min(arrives).min(asks));
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.alone().send(0, bytes);
        Ok(())
    }

    fn now(&mut self) -> Duration {
        Duration::from_micros(self.alone().now_us)
    }

    fn sleep(&mut self, time: Duration) {
        self.pass(time.as_millis() as u64);
    }

    fn ask_clock(&mut self) -> Box<dyn AskClock> {
        let mut world = self.0.lock().unwrap();
        world.next_asker += 1;
        let number = world.next_asker;
        world.askers.push((number, Asker::Awake));
        Box::new(VirtualClock(self.clone(), number))
    }

    fn stands_while_hosts_work(&self) -> bool {
        true
    }
}
