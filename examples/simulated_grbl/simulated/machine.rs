//! The reaction of a simulated board to bytes and to time, as grbl's documentation describes it
//! (doc/markdown of grbl 1.1: interface, jogging, settings, commands).

use std::collections::VecDeque;

use super::motor::{Motor, OTHERS};
use super::number::print;
use super::options::{Defects, Firmware, Options, Random, Sensor};
use super::settings::Settings;

/// Most bytes that wait to be read; more are lost.
const RECEIVE_BUFFER: usize = 128;

/// Longest line that the board reads, bytes.
const LONGEST_LINE: usize = 80;

/// Number of reports from one with `WCO` to the next: at rest and in motion.
const OFFSET_EVERY: [u32; 2] = [10, 30];

/// State of a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    Idle,
    Jog,
    /// A probing move.
    Run,
    Hold,
    Alarm,
    Sleep,
}

/// Text that leaves the board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Output {
    Line(String),
    /// The answer to a line, which may be late.
    Answer(String),
}

/// Simulated board.
#[derive(Debug)]
pub(crate) struct Machine {
    pub(super) settings: Settings,
    pub(super) motor: Motor,
    pub(super) state: State,
    pub firmware: Firmware,
    pub(super) text: &'static str,
    pub defects: Defects,
    pub random: Random,
    /// Number of axes that reports tell. Only the first moves by itself; the next two go along with it.
    axes: usize,
    sensor: Option<Sensor>,
    /// Bytes that were received and not read.
    received: VecDeque<u8>,
    line: String,
    /// A jog that waits for room in the planner's queue.
    pub(super) pending: Option<(i64, f64, [i64; OTHERS])>,
    pub output: Vec<Output>,
    /// Steps of the motor since it was switched on: `true_steps` less those in reverse, `turned` in all.
    pub true_steps: i64,
    pub turned: u64,
    /// Steps of the motors of the other axes since the board was switched on, less those in reverse.
    pub others: [i64; OTHERS],
    /// Error of the board's counter, steps.
    pub miscounted: i64,
    /// Work coordinates less machine coordinates of the first axis, mm.
    pub(super) offset_mm: f32,
    pub(super) inches: bool,
    pub(super) relative: bool,
    pub(super) motion: &'static str,
    until_offset: u32,
    /// True if the motor stands although it should not.
    pub stalled: bool,
    /// Board time left while a setting is stored, s.
    pub storing_s: f64,
    /// Number of jogs and of lists of settings so far, and every line that was read.
    pub(super) jogs: u32,
    pub(super) lists: u32,
    pub lines: Vec<String>,
    /// Count at which the sensor answered in the probing move under way.
    touched: Option<i64>,
}

impl Machine {
    /// Returns a board that was just switched on.
    pub(crate) fn new(options: &Options) -> Self {
        let settings = Settings::new(options);
        let mut machine = Self {
            settings,
            motor: Motor::default(),
            state: State::Idle,
            firmware: options.firmware,
            text: options.text,
            defects: options.defects.clone(),
            random: Random::new(options.defects.seed),
            sensor: options.sensor,
            axes: options.axes,
            received: VecDeque::new(),
            line: String::new(),
            pending: None,
            output: Vec::new(),
            true_steps: 0,
            turned: 0,
            others: [0; OTHERS],
            miscounted: 0,
            offset_mm: -5.0,
            inches: false,
            relative: false,
            motion: "G0",
            until_offset: 0,
            stalled: false,
            storing_s: 0.0,
            jogs: 0,
            lists: 0,
            lines: Vec::new(),
            touched: None,
        };
        machine.initialize();
        machine
    }

    fn initialize(&mut self) {
        self.state = if self.settings.get(22) != 0.0 { State::Alarm } else { State::Idle };
        self.apply();
    }

    /// Applies the settings to the motor.
    pub(super) fn apply(&mut self) {
        self.motor.acceleration = f64::from(self.settings.get(120) * self.settings.get(100));
    }

    /// Starts the processor anew, and the counter with it.
    pub(super) fn power_on(&mut self) {
        self.motor.zero();
        self.miscounted = 0;
        self.forget();
        self.initialize();
    }

    fn forget(&mut self) {
        self.received.clear();
        self.line.clear();
        self.pending = None;
        self.output.clear();
        self.until_offset = 0;
        self.motor.stopping = false;
        self.touched = None;
        (self.inches, self.relative, self.motion) = (false, false, "G0");
    }

    /// Says the lines of a board that has started.
    pub(super) fn banner(&mut self) {
        self.say(match self.firmware {
            Firmware::Grbl => "Grbl 1.1h ['$' for help]",
            Firmware::Grbl09 => "Grbl 0.9j ['$' for help]",
            Firmware::GrblHal => "GrblHAL 1.1f ['$' or '$HELP' for help]",
            Firmware::FluidNc => "Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]",
        });
        if self.state == State::Alarm {
            self.say("[MSG:'$H'|'$X' to unlock]");
        }
    }

    pub(super) fn say(&mut self, line: &str) {
        self.output.push(Output::Line(line.to_owned()));
    }

    pub(super) fn answer(&mut self, answer: Result<(), u16>) {
        let text = answer.map_or_else(|code| format!("error:{code}"), |()| "ok".to_owned());
        self.output.push(Output::Answer(text));
    }

    /// Takes a byte from the line.
    pub(crate) fn receive(&mut self, byte: u8) {
        if self.storing_s > 0.0 {
            return;
        }
        match byte {
            b'?' if self.defects.deaf.is_some_and(|place| self.turned >= place) => {}
            b'?' => self.report(),
            b'!' => self.hold(),
            b'~' if self.state == State::Hold && self.motor.stands() => {
                self.motor.stopping = false;
                self.state = if self.motor.is_done() { State::Idle } else { State::Run };
            }
            b'~' => {}
            0x18 => self.soft_reset(),
            0x85 => self.cancel(),
            0x80.. => {}
            _ if self.received.len() < RECEIVE_BUFFER => self.received.push_back(byte),
            _ => {}
        }
    }

    fn cancel(&mut self) {
        if self.state != State::Jog {
            return;
        }
        if self.defects.lost_cancels > 0 {
            self.defects.lost_cancels -= 1;
            return;
        }
        self.motor.stopping = true;
    }

    fn hold(&mut self) {
        match self.state {
            State::Jog => self.motor.stopping = true,
            State::Run => {
                self.state = State::Hold;
                self.motor.stopping = true;
            }
            State::Idle => self.state = State::Hold,
            _ => {}
        }
    }

    fn soft_reset(&mut self) {
        let moving = matches!(self.state, State::Jog | State::Run | State::Hold) && !self.motor.stands();
        self.motor.halt();
        self.forget();
        self.state = match self.state {
            State::Alarm | State::Sleep => State::Alarm,
            _ if moving => State::Alarm,
            _ => State::Idle,
        };
        if moving {
            self.say("ALARM:3");
        }
        self.banner();
    }

    /// Stops at once and locks.
    pub(super) fn alarm(&mut self, code: u16) {
        self.motor.halt();
        self.pending = None;
        self.state = State::Alarm;
        self.say(&format!("ALARM:{code}"));
        self.say("[MSG:Reset to continue]");
    }

    /// Lets time pass on the board, s.
    pub(crate) fn advance(&mut self, time_s: f64) {
        if self.storing_s > 0.0 {
            self.storing_s = (self.storing_s - time_s).max(0.0);
            if self.storing_s == 0.0 {
                self.answer(Ok(()));
            }
        }
        if self.stalled {
            return;
        }
        let (sensor, probing, miscounted) = (self.sensor, self.state == State::Run, self.miscounted);
        let (before, others_before) = (self.motor.step(), self.motor.others());
        let mut touched = self.touched;
        self.motor.advance(time_s, |step| {
            if probing && touched.is_none() && sensor.is_some_and(|sensor| sensor.answers(step)) {
                touched = Some(step + miscounted);
                return false;
            }
            true
        });
        let travelled = self.motor.step() - before;
        self.true_steps += travelled;
        self.turned += travelled.unsigned_abs();
        for (axis, (now, before)) in self.motor.others().iter().zip(others_before).enumerate() {
            self.others[axis] += now - before;
        }
        if touched != self.touched {
            self.touched = touched;
            self.motor.stopping = true;
        }
        self.settle();
    }

    /// Changes the state once the motor stands.
    fn settle(&mut self) {
        if !self.motor.stands() {
            return;
        }
        match self.state {
            State::Jog if self.motor.stopping => {
                self.motor.halt();
                self.pending_is_dropped();
                self.state = State::Idle;
            }
            State::Jog if self.motor.is_done() && self.pending.is_none() => self.state = State::Idle,
            State::Run if self.motor.stopping => {
                self.motor.halt();
                self.state = State::Idle;
                self.probed(true);
            }
            State::Run if self.motor.is_done() => {
                self.say("ALARM:5");
                self.probed(false);
                self.state = State::Alarm;
            }
            _ => {}
        }
    }

    /// Answers a jog that waited for room: it is cancelled with the others, and was taken.
    fn pending_is_dropped(&mut self) {
        if self.pending.take().is_some() {
            self.answer(Ok(()));
        }
    }

    fn probed(&mut self, found: bool) {
        let at = self.touched.take().unwrap_or(0);
        let place = print(self.reported(at), self.decimals());
        let zero = print(0.0, self.decimals());
        self.say(&format!("[PRB:{place},{zero},{zero}:{}]", u8::from(found)));
        self.answer(Ok(()));
    }

    /// Returns true if the sensor answers where the motor stands.
    pub(super) fn touches(&self) -> bool {
        self.sensor.is_some_and(|sensor| sensor.answers(self.motor.step()))
    }

    /// Returns the steps as the board counts them.
    pub(super) fn counted(&self) -> i64 {
        self.motor.step() + self.miscounted
    }

    /// Returns the coordinate of a count, in the unit of reports.
    fn reported(&self, count: i64) -> f32 {
        self.reported_on(count, 0)
    }

    fn reported_on(&self, count: i64, axis: usize) -> f32 {
        let mm = count as f32 / self.settings.get(100 + axis as u16);
        if self.settings.get(13) != 0.0 { mm * (1.0 / 25.4) } else { mm }
    }

    fn decimals(&self) -> u32 {
        if self.settings.get(13) != 0.0 { 4 } else { 3 }
    }

    fn report(&mut self) {
        let state = match self.state {
            State::Idle => "Idle",
            State::Jog => "Jog",
            State::Run => "Run",
            State::Hold if self.motor.stands() => "Hold:0",
            State::Hold => "Hold:1",
            State::Alarm => "Alarm",
            State::Sleep => "Sleep",
        };
        let mask = self.settings.get(10) as u32;
        let decimals = self.decimals();
        let offset = if self.settings.get(13) != 0.0 { self.offset_mm / 25.4 } else { self.offset_mm };
        let machine = self.reported(self.counted());
        let counts = self.motor.others();
        let others_mm: Vec<f32> = (1..self.axes)
            .map(|axis| counts.get(axis - 1).map_or(0.0, |count| self.reported_on(*count, axis)))
            .collect();
        let triple = |first: f32, others: &[f32]| {
            let rest = (1..self.axes).map(|axis| others.get(axis - 1).copied().unwrap_or(0.0));
            let all: Vec<_> =
                std::iter::once(first).chain(rest).map(|place| print(place, decimals)).collect();
            all.join(",")
        };
        let place = if mask & 1 != 0 {
            format!("MPos:{}", triple(machine, &others_mm))
        } else {
            format!("WPos:{}", triple(machine - offset, &others_mm))
        };
        let mut text = format!("<{state}|{place}");
        if mask & 2 != 0 {
            text += &format!("|Bf:{},{}", self.motor.room(), RECEIVE_BUFFER - self.received.len());
        }
        let speed = if self.stalled { 0.0 } else { self.motor.speed() };
        text += &format!("|FS:{:.0},0", speed * 60.0 / f64::from(self.settings.get(100)));
        if self.until_offset == 0 {
            text += &format!("|WCO:{}", triple(offset, &[]));
            self.until_offset = OFFSET_EVERY[usize::from(self.state != State::Idle)];
        }
        self.until_offset -= 1;
        self.say(&(text + ">"));
    }

    /// Reads lines as long as none has to wait.
    pub(crate) fn work(&mut self) {
        if let Some((end, steps_s, others)) = self.pending {
            if self.motor.is_full() {
                return;
            }
            self.pending = None;
            self.motor.push(end, steps_s, others);
            self.answer(Ok(()));
        }
        while self.pending.is_none()
            && self.state != State::Run
            && self.state != State::Hold
            && self.storing_s == 0.0
        {
            let Some(byte) = self.received.pop_front() else { return };
            match byte {
                b'\n' | b'\r' => {
                    let line = std::mem::take(&mut self.line);
                    self.lines.push(line.clone());
                    if line.len() > LONGEST_LINE {
                        self.answer(Err(11));
                    } else {
                        self.execute(&line);
                    }
                }
                b' ' => {}
                _ => self.line.push(char::from(byte).to_ascii_uppercase()),
            }
        }
    }
}
