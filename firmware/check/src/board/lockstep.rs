//! A board in an emulator as a wire to the drive. The board's time is the only clock: it goes on while the host waits,
//! and stands while the host works. So a slow computer changes no result.

use std::fmt;
use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use pump_bench::drives::wire::{AskClock, Wire};

/// Shortest look at the line, in ns: a tick of the board.
const LOOK_NS: f64 = 1e3;

/// Board in an emulator, which runs only when it is told.
pub(crate) trait Machine: Send + 'static {
    /// Longest time for which the board runs before the host looks again, in ns.
    const SLICE_NS: f64;

    /// Returns the time of the board, in ns.
    fn now_ns(&self) -> f64;

    /// Runs until a time, in ns, or until the board has said something. A board that cannot tell so has short slices.
    fn advance(&mut self, until_ns: f64) -> io::Result<()>;

    /// Returns the bytes of the board that the host has not read.
    fn said(&mut self) -> &mut Vec<u8>;

    /// Gives the board bytes, from now on.
    fn give(&mut self, bytes: &[u8]);
}

/// Thread of a drive that asks for leave while another one streams. The board runs only while all of them wait.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Asker {
    /// It works, and the board's time stands.
    Works,
    /// It waits until this time of the board, in ns.
    Waits(f64),
}

/// Board with the threads that ask for leave.
pub(crate) struct Shared<M> {
    pub(crate) machine: M,
    /// Threads, each with its number.
    askers: Vec<(u64, Asker)>,
    next_asker: u64,
}

/// Wire to a board that runs only as far as the host waits. Clones lead to the same board.
pub(crate) struct Lockstep<M>(Arc<(Mutex<Shared<M>>, Condvar)>);

impl<M> Clone for Lockstep<M> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<M: Machine> fmt::Debug for Lockstep<M> {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.debug_struct("Lockstep").field("now_ns", &self.shared().machine.now_ns()).finish_non_exhaustive()
    }
}

impl<M: Machine> Lockstep<M> {
    /// Wires a board.
    pub(crate) fn over(machine: M) -> Self {
        Self(Arc::new((Mutex::new(Shared { machine, askers: Vec::new(), next_asker: 0 }), Condvar::new())))
    }

    /// Returns the board at once, whoever works.
    pub(crate) fn shared(&self) -> MutexGuard<'_, Shared<M>> {
        self.0.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the board once the threads that ask for leave wait.
    fn alone(&self) -> MutexGuard<'_, Shared<M>> {
        let works = |shared: &mut Shared<M>| shared.askers.iter().any(|(_, asker)| *asker == Asker::Works);
        let waited = self.0.1.wait_while(self.shared(), works);
        waited.unwrap_or_else(PoisonError::into_inner)
    }

    /// Runs until a time, in ns, or until the board has said something if `hears` is true. The threads that ask for
    /// leave have their turns on the way.
    fn run(&self, until_ns: f64, hears: bool) -> io::Result<MutexGuard<'_, Shared<M>>> {
        let mut shared = self.alone();
        loop {
            let now_ns = shared.machine.now_ns();
            let due = |asker: &Asker| matches!(asker, Asker::Waits(at_ns) if *at_ns <= now_ns);
            // One at a time, so that a check is the same in every run.
            if let Some((_, asker)) = shared.askers.iter_mut().find(|(_, asker)| due(asker)) {
                *asker = Asker::Works;
                self.0.1.notify_all();
                drop(shared);
                shared = self.alone();
                continue;
            }
            if now_ns >= until_ns || hears && !shared.machine.said().is_empty() {
                return Ok(shared);
            }
            let asks_ns = shared.askers.iter().fold(until_ns, |soonest, (_, asker)| match asker {
                Asker::Waits(at_ns) => soonest.min(*at_ns),
                Asker::Works => soonest,
            });
            shared.machine.advance(until_ns.min(asks_ns).min(now_ns + M::SLICE_NS))?;
        }
    }
}

impl<M: Machine> Wire for Lockstep<M> {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        let until_ns = self.alone().machine.now_ns() + (wait.as_nanos() as f64).max(LOOK_NS);
        let mut shared = self.run(until_ns, true)?;
        let said = shared.machine.said();
        let read = buffer.len().min(said.len());
        buffer.iter_mut().zip(said.drain(..read)).for_each(|(to, byte)| *to = byte);
        Ok(read)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.alone().machine.give(bytes);
        Ok(())
    }

    fn now(&mut self) -> Duration {
        Duration::from_nanos(self.alone().machine.now_ns() as u64)
    }

    fn sleep(&mut self, time: Duration) {
        let until_ns = self.alone().machine.now_ns() + time.as_nanos() as f64;
        // A board that is gone is the next read's error.
        drop(self.run(until_ns, false));
    }

    fn ask_clock(&mut self) -> Box<dyn AskClock> {
        let mut shared = self.shared();
        shared.next_asker += 1;
        let number = shared.next_asker;
        shared.askers.push((number, Asker::Works));
        Box::new(BoardClock(self.clone(), number))
    }

    fn stands_while_hosts_work(&self) -> bool {
        true
    }
}

/// Clock of a thread that asks for leave, in the board's time.
struct BoardClock<M>(Lockstep<M>, u64);

impl<M: Machine> fmt::Debug for BoardClock<M> {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.debug_tuple("BoardClock").field(&self.0).finish()
    }
}

impl<M: Machine> AskClock for BoardClock<M> {
    fn wait(&self, time: Duration) -> bool {
        let number = self.1;
        let mut shared = self.0.shared();
        let at_ns = shared.machine.now_ns() + time.as_nanos() as f64;
        let Some((_, asker)) = shared.askers.iter_mut().find(|(n, _)| *n == number) else { return false };
        *asker = Asker::Waits(at_ns);
        self.0.0.1.notify_all();
        let waits = |shared: &mut Shared<M>| {
            shared.askers.iter().any(|(n, asker)| *n == number && *asker != Asker::Works)
        };
        let waited = self.0.0.1.wait_while(shared, waits).unwrap_or_else(PoisonError::into_inner);
        waited.askers.iter().any(|(n, _)| *n == number)
    }

    fn end(&self) {
        self.0.shared().askers.retain(|(number, _)| *number != self.1);
        self.0.0.1.notify_all();
    }
}
