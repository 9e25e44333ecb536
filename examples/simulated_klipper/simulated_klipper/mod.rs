//! A simulated board with Klipper's firmware, at the end of a pseudo-terminal.
//!
//! It is written from the firmware's documentation and is strict: a command that comes late, does not fit or is out of
//! place shuts it down, with the firmware's own words. It shares no code with the drive that speaks to it.

mod board;
mod clock;
mod codec;
mod dictionary;
mod line;
mod noise;
mod options;
mod parts;
mod simulation;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{JoinHandle, sleep};
use std::time::{Duration, Instant};

use clock::Clock;
use line::Line;
use options::SOCKETS;
pub(crate) use options::{Character, IndexSensor, pin_of};
use simulation::Simulation;

/// Words for what a person's hand does at the board.
pub(crate) const HANDS: &str = "the words are: reset, pull, plug, cut, restore, shutdown, jump <ticks>, fault <socket> \
                                <flag>, mend <socket> <flag>; each on a line of its own";

/// Truth about a board, whatever the board says.
#[derive(Debug, Clone, Default)]
pub(crate) struct Truth {
    /// Steps that the motors of the sockets X, Y, Z and E have made, those in reverse taken off.
    pub(crate) steps: [i64; 4],
    /// Steps of motors that had no current.
    pub(crate) stray: u64,
    /// True if a motor turns.
    pub(crate) moving: bool,
    /// True once the host has configured the board.
    pub(crate) configured: bool,
    /// Reason of the shutdown that the board is in.
    pub(crate) shutdown: Option<&'static str>,
    /// Most commands that its queue has held.
    pub(crate) most_used: u16,
    /// Tick of its clock.
    pub(crate) now: u64,
    /// The clock itself.
    clock: Option<Clock>,
    /// GCONF, IHOLD_IRUN and CHOPCONF of each driver that has a line.
    pub(crate) drivers: Vec<[u32; 3]>,
    /// Datagrams of the host on the line to the drivers.
    pub(crate) asked: u64,
    /// True ends the simulation.
    over: bool,
}

/// Person's hand at the board.
#[derive(Debug)]
enum Hand {
    Reset,
    Pull,
    Plug,
    /// The motors' supply is cut, or there again.
    Supply(bool),
    /// The firmware shuts down by itself.
    Shutdown,
    Jump(u64),
    Fault {
        socket: usize,
        fault: String,
        is_there: bool,
    },
}

/// State that the simulation shares with its owner.
#[derive(Debug, Default)]
struct Shared {
    truth: Truth,
    hands: Vec<Hand>,
    answers: Vec<Result<(), String>>,
}

/// Simulated board that runs in a thread of its own until it is dropped.
#[derive(Debug)]
pub(crate) struct SimulatedKlipper {
    path: PathBuf,
    shared: Arc<Mutex<Shared>>,
    thread: Option<JoinHandle<()>>,
}

impl SimulatedKlipper {
    /// Switches a board of this character on.
    pub(crate) fn start_as(character: Character) -> io::Result<Self> {
        let (line, path) = Line::new()?;
        let mut simulation = Simulation::new(character, line)?;
        let shared = Arc::new(Mutex::new(Shared::default()));
        let seen = Arc::clone(&shared);
        let thread = std::thread::spawn(move || simulation.run(&seen));
        Ok(Self { path, shared, thread: Some(thread) })
    }

    /// Returns the device that the board is connected to.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the truth about the board now.
    pub(crate) fn truth(&self) -> Truth {
        lock(&self.shared).truth.clone()
    }

    /// Returns the instant at which the board's clock stands at a tick. `None` before its first look.
    #[allow(dead_code, reason = "tests compare the steps of two boards")]
    pub(crate) fn instant_of(&self, tick: u64) -> Option<Instant> {
        lock(&self.shared).truth.clock.map(|clock| clock.instant_of(tick))
    }

    /// Does what a person's hand does at the board, in the words of [`HANDS`].
    pub(crate) fn touch(&self, words: &str) -> Result<(), String> {
        let Some(hand) = hand(words)? else { return Ok(()) };
        lock(&self.shared).hands.push(hand);
        // The board answers at its next look, within some milliseconds.
        while self.thread.as_ref().is_some_and(|thread| !thread.is_finished()) {
            if let Some(answer) = lock(&self.shared).answers.pop() {
                return answer;
            }
            sleep(Duration::from_millis(1));
        }
        Err("the board is over".to_owned())
    }
}

impl Drop for SimulatedKlipper {
    fn drop(&mut self) {
        lock(&self.shared).truth.over = true;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Returns the place of the socket of this name.
pub(crate) fn socket_of(name: &str) -> Result<usize, String> {
    let place = SOCKETS.iter().position(|socket| socket.name.eq_ignore_ascii_case(name));
    place.ok_or_else(|| format!("`{name}` is none of the sockets X, Y, Z and E"))
}

/// Reads the words of [`HANDS`].
fn hand(words: &str) -> Result<Option<Hand>, String> {
    let words: Vec<_> = words.split_whitespace().collect();
    Ok(Some(match words.as_slice() {
        [] => return Ok(None),
        ["reset"] => Hand::Reset,
        ["pull"] => Hand::Pull,
        ["plug"] => Hand::Plug,
        ["cut"] => Hand::Supply(false),
        ["restore"] => Hand::Supply(true),
        ["shutdown"] => Hand::Shutdown,
        ["jump", ticks] => Hand::Jump(ticks.parse().map_err(|_| format!("`{ticks}` is no number of ticks"))?),
        [word @ ("fault" | "mend"), socket, fault] => {
            let is_there = *word == "fault";
            Hand::Fault { socket: socket_of(socket)?, fault: (*fault).to_owned(), is_there }
        }
        _ => return Err(HANDS.to_owned()),
    }))
}

fn lock(shared: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
