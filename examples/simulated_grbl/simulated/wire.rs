//! The pseudo-terminal between a simulated board and the program that opens it.

use std::io;
use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use rustix::pty::OpenptFlags;
use rustix::termios::ControlModes;

use super::line::Line;
use super::options::Options;
use super::{Truth, lock};

/// Time between two looks at the line.
const TICK: Duration = Duration::from_micros(700);

/// Silence of the user after which time stands still on a patient board. Users ask every 50 ms.
const PATIENCE: Duration = Duration::from_millis(70);

/// Longest time that a late thread of a patient board makes up at once, s of board time.
const PATIENT_TICK_S: f64 = 0.005;

/// Longest time that a late thread makes up at once, s of board time.
const LONGEST_TICK_S: f64 = 0.25;

/// Longest piece of board time between two looks at what was read, s.
const PIECE_S: f64 = 1e-3;

/// Board's end of the line.
#[derive(Debug)]
pub(super) struct Wire {
    /// Pseudo-terminal to the other end; none once the cable is pulled.
    terminal: Option<OwnedFd>,
    line: Line,
    truth: Arc<Mutex<Truth>>,
    open: bool,
    /// True if DTR falls when the port is closed.
    hangs_up: bool,
    /// Instant at which the board was switched on, and the time since then at which something was last heard.
    begun: Instant,
    heard: Duration,
}

impl Wire {
    /// Returns a board that is switched on, and the path of the other end.
    pub(super) fn new(options: Options, truth: Arc<Mutex<Truth>>) -> io::Result<(Self, PathBuf)> {
        let terminal = rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        rustix::pty::grantpt(&terminal)?;
        rustix::pty::unlockpt(&terminal)?;
        let name = rustix::pty::ptsname(&terminal, Vec::new())?;
        let path = PathBuf::from(name.to_string_lossy().into_owned());
        rustix::fs::fcntl_setfl(&terminal, OFlags::RDWR | OFlags::NONBLOCK)?;
        // A line reports that it is closed only after it was open once.
        drop(rustix::fs::open(&path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?);
        let wire = Self {
            terminal: Some(terminal),
            line: Line::new(options),
            truth,
            open: false,
            hangs_up: true,
            begun: Instant::now(),
            heard: Duration::ZERO,
        };
        Ok((wire, path))
    }

    /// Runs until the truth says that the simulation is over.
    pub(super) fn run(&mut self) {
        let mut before = Duration::ZERO;
        while !self.publish() {
            std::thread::sleep(TICK);
            let now = self.begun.elapsed();
            let options = &self.line.options;
            self.note_pause(now - before);
            let passed_s = (now - before).as_secs_f64() * options.time_scale;
            let longest_s = if options.patient { PATIENT_TICK_S } else { LONGEST_TICK_S };
            before = now;
            self.read(now);
            let waits = self.line.options.patient && now - self.heard > PATIENCE;
            self.pass(now, if waits { 0.0 } else { passed_s.min(longest_s) });
            if self.line.is_pulled {
                self.terminal = None;
            }
            // The truth is there before anybody reads of it.
            self.publish();
            self.write();
        }
    }

    /// Lets `time_s` pass on the board in short pieces: a line that was read is obeyed at once, however late this
    /// thread is.
    fn pass(&mut self, now: Duration, time_s: f64) {
        let mut left_s = time_s;
        while left_s > PIECE_S {
            self.line.pass(now, PIECE_S);
            left_s -= PIECE_S;
        }
        self.line.pass(now, left_s);
    }

    /// Publishes the truth about the board. Returns true if the simulation is over.
    fn publish(&mut self) -> bool {
        let mut truth = lock(&self.truth);
        self.line.publish(&mut truth);
        truth.looks += 1;
        truth.over
    }

    /// Notes for how long the board was silent because nobody ran this thread.
    fn note_pause(&self, pause: Duration) {
        let mut truth = lock(&self.truth);
        truth.longest_pause = truth.longest_pause.max(pause);
    }

    fn read(&mut self, now: Duration) {
        let Some(terminal) = &self.terminal else { return };
        let mut bytes = [0; 256];
        match rustix::io::read(terminal, &mut bytes) {
            Ok(count) => {
                self.opened(now);
                self.heard = now;
                self.line.receive(bytes.get(..count).unwrap_or_default());
            }
            Err(Errno::AGAIN | Errno::INTR) => self.opened(now),
            // Nobody has the other end open.
            Err(_) => self.open = false,
        }
    }

    fn opened(&mut self, now: Duration) {
        if !std::mem::replace(&mut self.open, true) && self.line.options.resets_on_open && self.hangs_up {
            self.line.reset(now);
        }
        // DTR is as the last user of the port set it.
        if let Some(modes) = self.terminal.as_ref().and_then(|line| rustix::termios::tcgetattr(line).ok()) {
            self.hangs_up = modes.control_modes.contains(ControlModes::HUPCL) || !is_raw(&modes);
        }
    }

    fn write(&mut self) {
        if !self.open {
            self.line.outgoing.clear();
            return;
        }
        let bytes = self.line.leaving();
        if let (Some(terminal), false) = (&self.terminal, bytes.is_empty())
            && let Ok(written) = rustix::io::write(terminal, &bytes)
        {
            self.line.outgoing.drain(..written);
        }
    }
}

/// Returns true if a program has set up the port.
fn is_raw(modes: &rustix::termios::Termios) -> bool {
    !modes.local_modes.contains(rustix::termios::LocalModes::ICANON)
}
