//! A simulated balance at the end of a pseudo-terminal, under the vessel of a pump that a simulated board turns.

mod speech;
mod vessel;

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{JoinHandle, sleep};
use std::time::{Duration, Instant};

use rustix::pty::OpenptFlags;

pub(crate) use speech::Speech;
pub(crate) use vessel::{Defect, Truth, Vessel};

/// Time between two looks at the line and at the motor.
const TICK: Duration = Duration::from_millis(3);

/// Simulated balance that runs in a thread of its own until it is dropped.
#[derive(Debug)]
pub(crate) struct SimulatedBalance {
    path: PathBuf,
    vessel: Arc<Mutex<Vessel>>,
    pauses: Arc<Mutex<Duration>>,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl SimulatedBalance {
    /// Switches a balance on. `steps` tells the net steps that the motor has made.
    pub(crate) fn start(
        speech: Speech,
        vessel: Vessel,
        steps: impl Fn() -> i64 + Send + 'static,
    ) -> io::Result<Self> {
        let line = rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        rustix::pty::grantpt(&line)?;
        rustix::pty::unlockpt(&line)?;
        let name = rustix::pty::ptsname(&line, Vec::new())?;
        let path = PathBuf::from(name.to_string_lossy().into_owned());
        // An open handle keeps the line alive between two commands, and it echoes nothing.
        let held = File::options().read(true).write(true).open(&path)?;
        let mut attributes = rustix::termios::tcgetattr(&held)?;
        attributes.make_raw();
        rustix::termios::tcsetattr(&held, rustix::termios::OptionalActions::Now, &attributes)?;
        rustix::io::ioctl_fionbio(&line, true)?;
        let (vessel, pauses, ends) = (Arc::new(Mutex::new(vessel)), Arc::default(), Arc::default());
        let (shared, paused, ended) = (Arc::clone(&vessel), Arc::clone(&pauses), Arc::clone(&ends));
        let thread = std::thread::spawn(move || {
            let _held = held;
            talk(&mut File::from(line), speech, &shared, &paused, &ended, steps);
        });
        Ok(Self { path, vessel, pauses, ends, thread: Some(thread) })
    }

    /// Returns the device that the balance is connected to.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the vessel, which the balance waits for meanwhile.
    pub(crate) fn vessel(&self) -> MutexGuard<'_, Vessel> {
        lock(&self.vessel)
    }

    /// Returns the longest time for which the balance was silent because nobody ran its thread.
    pub(crate) fn longest_pause(&self) -> Duration {
        *lock(&self.pauses)
    }
}

impl Drop for SimulatedBalance {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Answers questions until `ends` is set.
fn talk(
    line: &mut File,
    speech: Speech,
    vessel: &Mutex<Vessel>,
    pauses: &Mutex<Duration>,
    ends: &AtomicBool,
    steps: impl Fn() -> i64,
) {
    let mut asked = Vec::new();
    let mut looked = Instant::now();
    while !ends.load(Ordering::Relaxed) {
        let (reading, defect) = {
            let mut vessel = lock(vessel);
            vessel.advance(steps());
            (vessel.reading(), vessel.defect())
        };
        let mut bytes = [0; 64];
        let count = line.read(&mut bytes).unwrap_or(0);
        asked.extend(bytes.iter().take(count));
        while let Some(end) = asked.iter().position(|byte| *byte == b'\n') {
            let question: Vec<u8> = asked.drain(..=end).collect();
            // Nobody may be at the other end.
            let _ = line.write_all(speech.answer(&question, &reading, defect).as_bytes());
        }
        sleep(TICK);
        let (now, mut longest) = (Instant::now(), lock(pauses));
        *longest = longest.max(now - looked);
        looked = now;
    }
}
