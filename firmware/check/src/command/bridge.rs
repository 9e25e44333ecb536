//! The emulated board at the end of a pseudo-terminal, in real time.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use pump_bench::drives::wire::Wire;

use super::carrier::Carrier;
use super::line::Line;
use super::silence::{Look, Silences, Waits, queued};
use crate::board::emulator::Emulator;

/// Shortest and longest time for which the board goes on between two looks at the line.
const LOOK: Duration = Duration::from_millis(1);
const SLICE: Duration = Duration::from_millis(2);

/// Longest time that a late emulator makes up. What is beyond, the board's time stands still.
const LONGEST_LAG: Duration = Duration::from_millis(20);

/// Longest time for which the board goes on without a byte of a host that runs. Its time stands until the host is heard
/// again, so a slow computer is no lost link. The silence of a host that had a processor is held apart.
const PATIENCE: Duration = Duration::from_millis(150);

/// Time of the board since a step within which its motor turns. The doses here make a step in some ms at most.
const TURNS_NS: f64 = 50e6;

/// Byte that ends a frame.
const END_OF_FRAME: u8 = 0;

/// State that the bridge's thread shares.
#[derive(Debug, Default)]
struct State {
    /// Process of the host. It is 0 while none runs.
    host: AtomicU32,
    is_over: AtomicBool,
    /// Time for which the board's time stood still, in us.
    stood_us: AtomicU64,
    /// Longest silence of a host while the motor turned, in us of the host's own time.
    silent_us: AtomicU64,
}

/// Emulated board at the end of a pseudo-terminal. It runs in a thread of its own until it is dropped.
pub(super) struct Bridge {
    port: PathBuf,
    began: Instant,
    state: Arc<State>,
    thread: Option<JoinHandle<io::Result<()>>>,
}

impl Bridge {
    /// Joins the line of a board to a pseudo-terminal.
    pub(super) fn new(emulator: Emulator) -> io::Result<Self> {
        let ((line, port), carrier) = (Line::new()?, Carrier::new()?);
        let state = Arc::new(State::default());
        let shared = Arc::clone(&state);
        let thread = Some(thread::spawn(move || serve(emulator, line, carrier, &shared)));
        Ok(Self { port, began: Instant::now(), state, thread })
    }

    /// Returns the device that the board is connected to.
    pub(super) fn port(&self) -> &Path {
        &self.port
    }

    /// Notes the process of the host, or that it has gone.
    pub(super) fn set_host(&self, process: Option<u32>) {
        self.state.host.store(process.unwrap_or(0), Ordering::Relaxed);
    }

    /// Returns the time of the bridge, and the part of it in which the board's time stood still.
    pub(super) fn times_s(&self) -> (f64, f64) {
        (self.began.elapsed().as_secs_f64(), 1e-6 * self.state.stood_us.load(Ordering::Relaxed) as f64)
    }

    /// Returns the longest silence of a host while the motor turned, in the host's own time.
    pub(super) fn longest_silence(&self) -> Duration {
        Duration::from_micros(self.state.silent_us.load(Ordering::Relaxed))
    }

    /// Takes the line away, with its device. The board's time stands.
    pub(super) fn pull(&mut self) {
        self.state.is_over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }

    /// Returns true while the emulator runs.
    pub(super) fn is_live(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }
}

impl Drop for Bridge {
    fn drop(&mut self) {
        self.pull();
    }
}

/// Runs the board by the computer's clock, and hands on the bytes of both ends.
fn serve(mut emulator: Emulator, mut line: Line, mut carrier: Carrier, state: &State) -> io::Result<()> {
    let mut buffer = [0; 4096];
    let began = Instant::now();
    let (mut before, mut owed) = (began, Duration::ZERO);
    let mut heard = emulator.now();
    let (mut silences, mut uncarried) = (Silences::default(), Duration::ZERO);
    while !state.is_over.load(Ordering::Relaxed) {
        let sent = Instant::now();
        carrier.carry()?;
        uncarried += sent.elapsed().saturating_sub(LOOK);
        let from = emulator.now();
        let bytes = line.read();
        if !bytes.is_empty() {
            emulator.write(&bytes)?;
            heard = from;
        }
        let now = Instant::now();
        let host = Some(state.host.load(Ordering::Relaxed)).filter(|host| *host != 0);
        silences.look(Look {
            at: now - began,
            uncarried,
            queued: host.map_or_else(Waits::default, queued),
            has_frame: bytes.contains(&END_OF_FRAME),
            stepped_ns: host.and(stepped_ns(&emulator)),
        });
        state.silent_us.store(silences.longest().as_micros() as u64, Ordering::Relaxed);
        owed += now - before;
        before = now;
        let is_left_alone = host.is_some() && from.saturating_sub(heard) > PATIENCE;
        let made_up = if is_left_alone { Duration::ZERO } else { LONGEST_LAG };
        let stands = owed.saturating_sub(made_up);
        state.stood_us.fetch_add(stands.as_micros() as u64, Ordering::Relaxed);
        owed -= stands;
        if owed < LOOK {
            thread::sleep(LOOK);
            continue;
        }
        let read = emulator.read(&mut buffer, owed.min(SLICE))?;
        owed = owed.saturating_sub(emulator.now().saturating_sub(from));
        line.write(buffer.get(..read).unwrap_or_default());
    }
    Ok(())
}

/// Returns the time of the last step of a motor that turns.
fn stepped_ns(emulator: &Emulator) -> Option<f64> {
    let shared = emulator.shared();
    let stepped_ns = shared.machine.stepped_ns;
    (shared.machine.time_ns() - stepped_ns < TURNS_NS).then_some(stepped_ns)
}
