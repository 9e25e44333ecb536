//! A simulated grbl board at the end of a pseudo-terminal.

mod commands;
mod defects;
pub(crate) mod line;
mod machine;
mod motor;
mod number;
pub(crate) mod options;
mod settings;
mod wire;

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread::JoinHandle;
use std::time::Duration;

use options::Options;
use wire::Wire;

/// Looks of the board at its line after which a motor that stands is said to rest: some 100 ms.
const RESTS: u64 = 130;

/// The truth about a board, whatever the board says.
#[derive(Debug, Clone, Default)]
pub(crate) struct Truth {
    /// Steps that the motor has made since the board was switched on, those in reverse taken off.
    pub steps: i64,
    /// Steps of the motors of the axes Y and Z, which go along with the first.
    pub others: [i64; motor::OTHERS],
    /// True if the motor turns.
    pub moving: bool,
    /// Fastest speed of the motor so far, steps/s.
    pub peak_steps_s: f64,
    /// Number of the motor's starts from rest.
    pub starts: u64,
    /// Number of resets of the processor.
    pub resets: u32,
    /// Number of questions for the position that came by the line.
    pub asked: u64,
    /// Number of looks of the board at its line, after each of which it has obeyed all that had come.
    pub looks: u64,
    /// Longest time between two looks at the line. A busy machine makes it long, and the board silent meanwhile.
    pub longest_pause: Duration,
    /// Lines that the board has read.
    pub lines: Vec<String>,
    /// True ends the simulation.
    pub over: bool,
}

/// Simulated board that runs in a thread of its own until it is dropped.
#[derive(Debug)]
pub(crate) struct Simulated {
    path: PathBuf,
    truth: Arc<Mutex<Truth>>,
    thread: Option<JoinHandle<()>>,
}

impl Simulated {
    /// Switches a board on.
    pub(crate) fn start(options: Options) -> std::io::Result<Self> {
        let truth = Arc::new(Mutex::new(Truth::default()));
        let (mut wire, path) = Wire::new(options, Arc::clone(&truth))?;
        let thread = std::thread::spawn(move || wire.run());
        Ok(Self { path, truth, thread: Some(thread) })
    }

    /// Returns the device that the board is connected to.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the truth about the board now.
    pub(crate) fn truth(&self) -> Truth {
        lock(&self.truth).clone()
    }

    /// Waits until the motor has stood for a while, and returns the truth then. The board's own looks count, so that
    /// nothing waits for a thread that does not get to run.
    pub(crate) fn rest(&self) -> Truth {
        let mut truth = self.truth();
        let mut since = truth.looks;
        while truth.looks - since < RESTS {
            std::thread::sleep(Duration::from_millis(5));
            truth = self.truth();
            if truth.moving {
                since = truth.looks;
            }
        }
        truth
    }
}

impl Drop for Simulated {
    fn drop(&mut self) {
        lock(&self.truth).over = true;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn lock(truth: &Mutex<Truth>) -> MutexGuard<'_, Truth> {
    truth.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
