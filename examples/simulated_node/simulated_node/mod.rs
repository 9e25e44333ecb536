//! A simulated node at the end of a pseudo-terminal: the board's own logic (`pump-node`), with pins and motors in
//! software.

mod carrier;
mod hardware;
mod line;
mod version;

use std::collections::VecDeque;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{JoinHandle, sleep};
use std::time::{Duration, Instant};

use carrier::Carrier;
use hardware::{Hardware, SimulatedPins, TICK_HZ};
use line::Line;
use pump_node::{Axes, Axis, Node, identity};

/// Time between two looks at the line.
const LOOK: Duration = Duration::from_millis(1);

/// Longest time between two looks at a USB line, whose requests are taken and answered at once.
const USB_LOOK: Duration = Duration::from_micros(500);

/// Longest time, us, that a late board makes up at once, so that it hears its host before it goes on. A move may begin
/// in that time, and a board that has not listened meanwhile takes its own lateness for a lost link. A silent host is
/// another matter: the board's time goes on without it. A board's clock that stands for longer is told as one that has
/// jumped, and pumps that begin together then learn it anew.
const LONGEST_LOOK_US: u64 = 50_000;

/// Longest time, us, that a late board at a USB port makes up at once. Its clock is compared with another one's.
const LONGEST_USB_LOOK_US: u64 = 100_000;

/// Rate of the line, bytes a second, as at 460,800 baud.
const BYTES_S: u64 = 46_080;

/// Words for what a person's hand does at the board.
pub(crate) const HANDS: &str =
    "the words are: estop, release, fault <axis>, mend <axis>, reset, pull, plug; each on a line of its own";

/// Character of a board.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Character {
    /// Number of the board.
    pub(crate) number: u64,
    /// Version of the protocol that its firmware speaks, if it is another one.
    pub(crate) protocol: Option<u8>,
    /// Steps from one index mark to the next of each axis that has a sensor.
    pub(crate) index_steps: [Option<u32>; 4],
    /// True for each axis whose stepper driver's output is high in a fault, as DIAG of a TMC2209.
    pub(crate) fault_high: [bool; 4],
    /// True for a board at a USB port of its own.
    pub(crate) usb: bool,
}

/// Truth about a board, whatever the board says.
#[derive(Debug, Clone, Default)]
pub(crate) struct Truth {
    /// Steps that each motor has made, those in reverse taken off.
    pub(crate) steps: [i64; 4],
    /// Instant of the first step that each motor has made.
    pub(crate) first_steps: [Option<Instant>; 4],
    /// True if a motor turns.
    pub(crate) moving: bool,
    /// Rises of the step pins while their motors had no current.
    pub(crate) stray: u32,
    /// True ends the simulation.
    pub(crate) over: bool,
}

/// Simulated node that runs in a thread of its own until it is dropped.
#[derive(Debug)]
pub(crate) struct SimulatedNode {
    path: PathBuf,
    truth: Arc<Mutex<Truth>>,
    hardware: Hardware,
    thread: Option<JoinHandle<()>>,
}

impl SimulatedNode {
    /// Switches a board of this number on.
    #[allow(dead_code, reason = "the example names more than a number")]
    pub(crate) fn start(number: u64) -> io::Result<Self> {
        Self::start_as(Character { number, ..Character::default() })
    }

    /// Switches a board of this character on.
    pub(crate) fn start_as(character: Character) -> io::Result<Self> {
        let truth = Arc::new(Mutex::new(Truth::default()));
        let ((line, path), carrier) = (Line::new()?, Carrier::new()?);
        let (shared, hardware) = (Arc::clone(&truth), Hardware::default());
        hardware.sense_index(character.index_steps);
        hardware.report_high(character.fault_high);
        let simulation = (hardware.clone(), line);
        let thread = std::thread::spawn(move || Simulation::new(character, simulation).run(carrier, &shared));
        Ok(Self { path, truth, hardware, thread: Some(thread) })
    }

    /// Does what a person's hand does at the board, in the words of [`HANDS`].
    pub(crate) fn touch(&self, words: &str) -> Result<(), String> {
        self.hardware.touch(words)
    }

    /// Returns the device that the board is connected to.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the truth about the board now.
    pub(crate) fn truth(&self) -> Truth {
        lock(&self.truth).clone()
    }
}

impl Drop for SimulatedNode {
    fn drop(&mut self) {
        lock(&self.truth).over = true;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn lock(truth: &Mutex<Truth>) -> MutexGuard<'_, Truth> {
    truth.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the logic of a board that was just switched on.
fn power_up(
    character: Character,
    hardware: &Hardware,
) -> (Node, Axes<'static, SimulatedPins, Hardware, 256, 4>) {
    let axes = [0, 1, 2, 3].map(|axis| Axis::new(SimulatedPins::new(hardware, axis), TICK_HZ));
    // The board runs for as long as the program.
    let axes = Axes::new(Box::leak(Box::new(axes)), hardware.clone(), TICK_HZ);
    (Node::new(identity::<256, 4>(character.number, [0, 1, 0], TICK_HZ)), axes)
}

/// Board, its line, and its clock.
struct Simulation {
    character: Character,
    hardware: Hardware,
    node: Node,
    axes: Axes<'static, SimulatedPins, Hardware, 256, 4>,
    line: Line,
    now_us: u64,
    next_poll_us: u64,
    /// Answers on their way, each with the time at which it is through.
    answers: VecDeque<(u64, Vec<u8>)>,
}

impl Simulation {
    fn new(character: Character, (hardware, line): (Hardware, Line)) -> Self {
        let (node, axes) = power_up(character, &hardware);
        let answers = VecDeque::new();
        Self { character, hardware, node, axes, line, now_us: 0, next_poll_us: 0, answers }
    }

    fn run(&mut self, mut carrier: Carrier, truth: &Mutex<Truth>) {
        let mut before = Instant::now();
        loop {
            if self.character.usb {
                self.line.wait(USB_LOOK);
            } else {
                sleep(LOOK);
            }
            // A line without a computer is as good as no board.
            if carrier.carry().is_err() {
                return;
            }
            let said = self.line.read();
            let now = Instant::now();
            let longest_us = if self.character.usb { LONGEST_USB_LOOK_US } else { LONGEST_LOOK_US };
            let since_us = now.saturating_duration_since(before).as_micros() as u64;
            let passed_us = since_us.min(longest_us);
            // The rest of a microsecond counts at the next look.
            before += Duration::from_micros(since_us);
            if self.hardware.take_reset() {
                (self.node, self.axes) = power_up(self.character, &self.hardware);
            }
            // What has come is taken at a tick after it came.
            self.go_on(self.now_us + passed_us);
            self.hear(said);
            while self.answers.front().is_some_and(|(at, _)| *at <= self.now_us)
                && let Some((_, answer)) = self.answers.pop_front()
            {
                self.line.write(&answer);
            }
            let mut truth = lock(truth);
            (truth.steps, truth.stray) = self.hardware.counts();
            for (first, tick) in truth.first_steps.iter_mut().zip(self.hardware.first_rises()) {
                let at = |tick: u64| before - Duration::from_micros(self.now_us.saturating_sub(tick));
                *first = first.or(tick.map(at));
            }
            truth.moving = self.axes.is_moving();
            if truth.over {
                return;
            }
        }
    }

    /// Takes in what the host has said. A pulled cable carries nothing, in neither direction.
    fn hear(&mut self, said: Vec<u8>) {
        if self.hardware.is_pulled() {
            self.answers.clear();
            return;
        }
        for byte in said {
            if let Some(answer) = self.node.on_byte(byte, self.now_us, &mut self.axes) {
                let bytes = match self.character.protocol {
                    Some(version) => version::spoken(answer.bytes(), version),
                    None => answer.bytes().to_vec(),
                };
                let through = if self.character.usb { 0 } else { bytes.len() as u64 * 1_000_000 / BYTES_S };
                let through_us = self.now_us + through;
                self.answers.push_back((through_us, bytes));
            }
        }
    }

    /// Goes on from event to event.
    fn go_on(&mut self, until_us: u64) {
        while self.now_us < until_us {
            let alarm_us = self.axes.next_alarm().unwrap_or(u64::MAX);
            self.now_us = self.now_us.max(alarm_us.min(self.next_poll_us).min(until_us));
            self.hardware.set_now(self.now_us);
            if alarm_us <= self.now_us {
                let _ = self.axes.on_timer();
                self.now_us = self.now_us.max(self.hardware.now());
            }
            if self.now_us >= self.next_poll_us {
                self.next_poll_us = self.now_us + 1000;
                self.node.poll(self.now_us, &mut self.axes);
            }
        }
    }
}
