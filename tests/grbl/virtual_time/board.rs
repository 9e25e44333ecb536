//! A simulated board in memory, with a clock that goes on only where the drive waits.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use pump_bench::drives::wire::Wire;
use pump_bench::drives::{Grbl, Opening};
use pump_bench::pump_file::{DriveTable, DriverName};

use crate::rig::motor;
use crate::simulated::machine::{Machine, Output};
use crate::simulated::options::Options;

/// Time between two looks of the board at its motor.
const TICK: Duration = Duration::from_micros(500);

/// Truth about a board in memory, and what a test does to it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Truth {
    /// Steps that the motor has made, those in reverse taken off.
    pub(super) steps: i64,
    /// Time on the board's clock.
    pub(super) now: Duration,
    /// Factor by which the motor is slower than its settings say, less one.
    pub(super) slower: f64,
    /// Times for which the drive does not get to run: before its next look, and after the next line that it sends.
    pub(super) stalls: [Duration; 2],
    /// Byte that somebody else sends now.
    pub(super) pressed: Option<u8>,
    /// True if the board says that it jogs, whatever it does.
    pub(super) never_rests: bool,
    /// Distance by which every report is off from now on, in mm.
    pub(super) astray_mm: f64,
}

/// Board in memory at the end of a wire.
#[derive(Debug)]
struct InMemory {
    machine: Machine,
    outgoing: VecDeque<u8>,
    truth: Arc<Mutex<Truth>>,
}

impl InMemory {
    fn stall(&mut self, which: usize) {
        let stall = std::mem::take(&mut self.truth.lock().unwrap().stalls[which]);
        for _ in 0..stall.div_duration_f64(TICK) as u32 {
            self.tick(TICK);
        }
    }

    fn tick(&mut self, time: Duration) {
        let mut truth = self.truth.lock().unwrap();
        if let Some(byte) = truth.pressed.take() {
            self.machine.receive(byte);
        }
        self.machine.advance(time.as_secs_f64() / (1.0 + truth.slower));
        self.machine.suffer();
        self.machine.work();
        truth.now += time;
        truth.steps = self.machine.true_steps;
        for output in std::mem::take(&mut self.machine.output) {
            let (Output::Line(mut text) | Output::Answer(mut text)) = output;
            if truth.never_rests {
                text = text.replace("<Idle", "<Jog");
            }
            if truth.astray_mm != 0.0 {
                text = astray(&text, truth.astray_mm);
            }
            self.outgoing.extend(text.bytes().chain(*b"\r\n"));
        }
    }
}

/// Returns a status report whose first coordinate is off. Other lines stay as they are.
fn astray(text: &str, by_mm: f64) -> String {
    let Some((head, rest)) = text.split_once("MPos:") else { return text.to_owned() };
    let (first, others) = rest.split_once(',').unwrap();
    format!("{head}MPos:{:.3},{others}", first.parse::<f64>().unwrap() + by_mm)
}

impl Wire for InMemory {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        self.stall(0);
        let mut left = wait.max(TICK);
        while self.outgoing.is_empty() && !left.is_zero() {
            let tick = left.min(TICK);
            self.tick(tick);
            left -= tick;
        }
        let count = buffer.len().min(self.outgoing.len());
        for (byte, from) in buffer.iter_mut().zip(self.outgoing.drain(..count)) {
            *byte = from;
        }
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        bytes.iter().for_each(|byte| self.machine.receive(*byte));
        if bytes.ends_with(b"\n") {
            self.stall(1);
        }
        Ok(())
    }

    fn now(&mut self) -> Duration {
        self.truth.lock().unwrap().now
    }

    fn sleep(&mut self, time: Duration) {
        self.tick(time);
    }
}

/// Opens the driver with such a board. Returns it with the truth about the board.
pub(super) fn open(options: &Options) -> (Grbl, Arc<Mutex<Truth>>) {
    let truth = Arc::<Mutex<Truth>>::default();
    let machine = Machine::new(options);
    let board = InMemory { machine, outgoing: VecDeque::new(), truth: Arc::clone(&truth) };
    let table = DriveTable::of(DriverName::Grbl);
    let grbl = Grbl::over(Box::new(board), &table, &motor(), &Opening::default()).unwrap();
    (grbl, truth)
}
