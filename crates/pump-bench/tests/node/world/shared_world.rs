//! The world as the wire of a drive, whose time goes on while all that use it wait.

use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::time::Duration;

use pump_bench::drives::wire::{AskClock, Wire};

use super::hardware::Hardware;
use super::world::{Asker, Event, World};

/// World that a test and a drive share.
#[derive(Clone)]
pub(crate) struct SharedWorld(pub(crate) Arc<Mutex<World>>, Arc<Condvar>);

impl std::fmt::Debug for SharedWorld {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.write_str("SharedWorld")
    }
}

impl SharedWorld {
    pub(crate) fn new() -> Self {
        Self::of_board(0xb0a2d)
    }

    pub(crate) fn of_board(number: u64) -> Self {
        Self(Arc::new(Mutex::new(World::new(number))), Arc::default())
    }

    pub(crate) fn hardware<T>(&self, look: impl FnOnce(&mut Hardware) -> T) -> T {
        let hardware = self.0.lock().unwrap().hardware.clone();
        look(&mut hardware.0.lock().unwrap())
    }

    /// Returns the steps that the motor of axis X has made.
    pub(crate) fn count(&self) -> i64 {
        self.hardware(|hardware| hardware.motors[0].count)
    }

    pub(crate) fn rises(&self) -> Vec<u64> {
        self.hardware(|hardware| hardware.motors[0].rises.clone())
    }

    pub(crate) fn now_us(&self) -> u64 {
        self.0.lock().unwrap().now_us
    }

    /// Has something happen so many ms from now.
    pub(crate) fn plan(&self, in_ms: u64, event: Event) {
        let mut world = self.0.lock().unwrap();
        let at = world.now_us + in_ms * 1000;
        world.events.push_back((at, event));
    }

    /// Lets time pass without a host.
    pub(crate) fn pass(&self, ms: u64) {
        let mut world = self.0.lock().unwrap();
        let until = world.now_us + ms * 1000;
        while world.now_us < until {
            world.go_on(until);
        }
        world.to_host.clear();
    }
}

impl SharedWorld {
    /// Returns the world once the threads that ask for leave wait.
    fn alone(&self) -> MutexGuard<'_, World> {
        let world = self.0.lock().unwrap();
        let works = |world: &mut World| world.askers.iter().any(|(_, asker)| *asker == Asker::Awake);
        self.1.wait_while(world, works).unwrap()
    }

    /// Has a thread that asks for leave wait. Returns false if the other thread has ended.
    fn wait(&self, number: u64, time: Duration) -> bool {
        let mut world = self.0.lock().unwrap();
        let at = world.now_us + time.as_micros() as u64;
        let Some((_, asker)) = world.askers.iter_mut().find(|(n, _)| *n == number) else { return false };
        *asker = Asker::Waits(at);
        self.1.notify_all();
        let waits =
            |world: &mut World| world.askers.iter().any(|(n, asker)| *n == number && *asker != Asker::Awake);
        let world = self.1.wait_while(world, waits).unwrap();
        world.askers.iter().any(|(n, _)| *n == number)
    }

    /// Has the only thread that asks for leave wait. Returns false if the other thread has ended.
    pub(crate) fn hold_up(&self, time: Duration) -> bool {
        let first = self.0.lock().unwrap().askers.first().map(|(number, _)| *number);
        first.is_some_and(|number| self.wait(number, time))
    }
}

/// Clock of a thread that asks for leave.
#[derive(Debug)]
struct VirtualClock(SharedWorld, u64);

impl AskClock for VirtualClock {
    fn wait(&self, time: Duration) -> bool {
        self.0.wait(self.1, time)
    }

    fn end(&self) {
        self.0.0.lock().unwrap().askers.retain(|(number, _)| *number != self.1);
        self.0.1.notify_all();
    }
}

impl Wire for SharedWorld {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        let mut world = self.alone();
        // A look at the line takes time, too.
        let until = world.now_us + (wait.as_micros() as u64).max(1);
        loop {
            let now = world.now_us;
            let due = |asker: &Asker| matches!(asker, Asker::Waits(at) if *at <= now);
            // One at a time, so that a test is the same in every run.
            if let Some((_, asker)) = world.askers.iter_mut().find(|(_, asker)| due(asker)) {
                *asker = Asker::Awake;
                self.1.notify_all();
                drop(world);
                world = self.alone();
                continue;
            }
            let now = world.now_us;
            let here = world.to_host.iter().take(buffer.len()).take_while(|(at, _)| *at <= now).count();
            if here > 0 {
                buffer.iter_mut().zip(world.to_host.drain(..here)).for_each(|(to, (_, byte))| *to = byte);
                return Ok(here);
            }
            if now >= until {
                return Ok(0);
            }
            let arrives = world.to_host.front().map_or(until, |(at, _)| *at);
            let asks = world.askers.iter().map(|(_, asker)| match asker {
                Asker::Waits(at) => *at,
                Asker::Awake => now,
            });
            let asks = asks.min().unwrap_or(until);
            world.go_on(until.min(arrives).min(asks));
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.alone().send(0, bytes);
        Ok(())
    }

    fn now(&mut self) -> Duration {
        Duration::from_micros(self.alone().now_us)
    }

    fn sleep(&mut self, time: Duration) {
        self.pass(time.as_millis() as u64);
    }

    fn ask_clock(&mut self) -> Box<dyn AskClock> {
        let mut world = self.0.lock().unwrap();
        world.next_asker += 1;
        let number = world.next_asker;
        world.askers.push((number, Asker::Awake));
        Box::new(VirtualClock(self.clone(), number))
    }

    fn stands_while_hosts_work(&self) -> bool {
        true
    }
}
