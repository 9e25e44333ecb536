//! The pseudo-terminal between a simulated board and the program that opens it.

use std::collections::VecDeque;
use std::io;
use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use rustix::pty::OpenptFlags;
use rustix::termios::ControlModes;

use super::machine::{Machine, Output};
use super::options::Options;
use super::{Truth, lock};

/// Time between two looks at the line.
const TICK: Duration = Duration::from_micros(700);

/// Silence of the user after which time stands still on a patient board. Users ask every 50 ms.
const PATIENCE: Duration = Duration::from_millis(70);

/// Most bytes on their way out to which a board that talks by itself adds more.
const MOST_UNREAD: usize = 2048;

/// Longest time that a late thread of a patient board makes up at once, s of board time.
const PATIENT_TICK_S: f64 = 0.005;

/// Longest time that a late thread makes up at once, s of board time.
const LONGEST_TICK_S: f64 = 0.25;

/// Board's end of the line.
#[derive(Debug)]
pub(super) struct Wire {
    /// Line to the other end; none once the cable is pulled.
    line: Option<OwnedFd>,
    machine: Machine,
    options: Options,
    truth: Arc<Mutex<Truth>>,
    open: bool,
    /// True if DTR falls when the port is closed.
    hangs_up: bool,
    /// Time at which the processor will have started, after a reset.
    starts_at: Option<Instant>,
    /// Bytes on their way out.
    outgoing: VecDeque<u8>,
    /// Late answers with the times at which they are due. Lines that follow them do not wait.
    late: VecDeque<(Instant, String)>,
    silent: bool,
    /// Instant at which something was last heard, and that of the last report that nobody asked for.
    heard: Instant,
    reported: Instant,
}

impl Wire {
    /// Returns a board that is switched on, and the path of the other end.
    pub(super) fn new(options: Options, truth: Arc<Mutex<Truth>>) -> io::Result<(Self, PathBuf)> {
        let line = rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        rustix::pty::grantpt(&line)?;
        rustix::pty::unlockpt(&line)?;
        let name = rustix::pty::ptsname(&line, Vec::new())?;
        let path = PathBuf::from(name.to_string_lossy().into_owned());
        rustix::fs::fcntl_setfl(&line, OFlags::RDWR | OFlags::NONBLOCK)?;
        // A line reports that it is closed only after it was open once.
        drop(rustix::fs::open(&path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?);
        let wire = Self {
            line: Some(line),
            machine: Machine::new(&options),
            options,
            truth,
            open: false,
            hangs_up: true,
            starts_at: None,
            outgoing: VecDeque::new(),
            late: VecDeque::new(),
            silent: false,
            heard: Instant::now(),
            reported: Instant::now(),
        };
        Ok((wire, path))
    }

    /// Runs until the truth says that the simulation is over.
    pub(super) fn run(&mut self) {
        let mut before = Instant::now();
        while !self.publish() {
            std::thread::sleep(TICK);
            let now = Instant::now();
            let passed_s = (now - before).as_secs_f64() * self.options.time_scale;
            before = now;
            self.read();
            if let Some(at) = self.starts_at {
                if now >= at {
                    self.starts_at = None;
                    self.machine.banner();
                }
            } else {
                let waits = self.options.patient && now - self.heard > PATIENCE;
                let longest_s = if self.options.patient { PATIENT_TICK_S } else { LONGEST_TICK_S };
                self.machine.advance(if waits { 0.0 } else { passed_s.min(longest_s) });
                self.fail();
                self.machine.work();
                self.talk(now);
            }
            // The truth is there before anybody reads of it.
            self.publish();
            self.write(now);
        }
    }

    /// Publishes the truth about the board. Returns true if the simulation is over.
    fn publish(&mut self) -> bool {
        let motor = &self.machine.motor;
        let mut truth = lock(&self.truth);
        truth.steps = self.machine.true_steps;
        truth.moving = !motor.is_done() && !self.machine.stalled;
        truth.peak_steps_s = motor.peak;
        truth.starts = motor.starts;
        truth.lines.append(&mut self.machine.lines);
        truth.over
    }

    fn read(&mut self) {
        let Some(line) = &self.line else { return };
        let mut bytes = [0; 256];
        match rustix::io::read(line, &mut bytes) {
            Ok(count) => {
                self.opened();
                self.heard = Instant::now();
                for byte in bytes.iter().take(count) {
                    if self.starts_at.is_none() {
                        self.machine.receive(*byte);
                    }
                }
            }
            Err(Errno::AGAIN | Errno::INTR) => self.opened(),
            // Nobody has the other end open.
            Err(_) => self.open = false,
        }
    }

    fn opened(&mut self) {
        if !std::mem::replace(&mut self.open, true) && self.options.resets_on_open && self.hangs_up {
            self.reset();
        }
        // DTR is as the last user of the port set it.
        if let Some(modes) = self.line.as_ref().and_then(|line| rustix::termios::tcgetattr(line).ok()) {
            self.hangs_up = modes.control_modes.contains(ControlModes::HUPCL) || !is_raw(&modes);
        }
    }

    /// Starts the processor anew.
    fn reset(&mut self) {
        self.machine.power_on();
        self.outgoing.clear();
        self.late.clear();
        self.starts_at = Some(Instant::now() + self.options.boot);
        lock(&self.truth).resets += 1;
    }

    /// Says what nobody asked for.
    fn talk(&mut self, now: Instant) {
        if self.outgoing.len() > MOST_UNREAD {
            return;
        }
        if self.options.auto_report.is_some_and(|every| now - self.reported >= every) {
            self.reported = now;
            self.machine.receive(b'?');
        }
        if self.options.chatters {
            self.machine.say("[MSG:Spindle at speed]");
        }
    }

    /// Lets each defect happen at its place.
    fn fail(&mut self) {
        self.machine.suffer();
        let turned = self.machine.turned;
        let due = |place: Option<u64>| place.is_some_and(|place| turned >= place);
        let defects = &mut self.machine.defects;
        if due(defects.resets) {
            defects.resets = None;
            self.reset();
        } else if due(defects.unplugged) {
            defects.unplugged = None;
            self.line = None;
        } else if due(defects.silent) {
            self.silent = true;
        }
    }

    fn write(&mut self, now: Instant) {
        for output in std::mem::take(&mut self.machine.output) {
            match output {
                Output::Line(text) => self.put(&text),
                Output::Answer(text) => {
                    let most_us = self.machine.defects.late_ok.as_micros() as u64;
                    let delay = if most_us == 0 || self.machine.jogs == 0 {
                        0
                    } else {
                        self.machine.random.below(most_us)
                    };
                    self.late.push_back((now + Duration::from_micros(delay), text));
                }
            }
        }
        while self.late.front().is_some_and(|(due, _)| *due <= now) {
            if let Some((_, text)) = self.late.pop_front() {
                self.put(&text);
            }
        }
        if self.silent || !self.open {
            self.outgoing.clear();
            return;
        }
        let random = &mut self.machine.random;
        let most = match self.machine.defects.chopped {
            // Bytes leave in pieces, or all at once after a while.
            true if random.below(4) > 0 => 0,
            true if random.below(2) > 0 => random.below(9) as usize,
            _ => usize::MAX,
        };
        let count = self.outgoing.len().min(most);
        let bytes: Vec<u8> = self.outgoing.iter().copied().take(count).collect();
        if let (Some(line), false) = (&self.line, bytes.is_empty())
            && let Ok(written) = rustix::io::write(line, &bytes)
        {
            self.outgoing.drain(..written);
        }
    }

    /// Adds a line to the outgoing bytes, with the defects of the wire.
    fn put(&mut self, text: &str) {
        let (random, defects) = (&mut self.machine.random, &self.machine.defects);
        if defects.noise && random.below(4) == 0 {
            let noise = (0..random.below(12)).map(|_| random.below(256) as u8).filter(|byte| *byte != b'\n');
            let noise: Vec<u8> = noise.collect();
            self.outgoing.extend(noise);
            self.outgoing.extend(b"\r\n");
        }
        // The end of an answer's line is lost where a report follows.
        let merges = defects.chopped && text.starts_with('<') && random.below(3) == 0;
        if merges && self.outgoing.ends_with_ok() {
            self.outgoing.truncate(self.outgoing.len() - 2);
        }
        self.outgoing.extend(text.as_bytes());
        self.outgoing.extend(b"\r\n");
    }
}

/// End of a queue of bytes.
trait Ends {
    fn ends_with_ok(&self) -> bool;
}

impl Ends for VecDeque<u8> {
    fn ends_with_ok(&self) -> bool {
        self.iter().rev().take(4).eq(b"\n\rko")
    }
}

/// Returns true if a program has set up the port.
fn is_raw(modes: &rustix::termios::Termios) -> bool {
    !modes.local_modes.contains(rustix::termios::LocalModes::ICANON)
}
