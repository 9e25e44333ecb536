//! Pins, a delay and a clock that record each event with its time, and a rotor that follows the pins.

use std::cell::{RefCell, RefMut};
use std::rc::Rc;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorKind, ErrorType, InputPin, OutputPin};
use pump_ctl::drive::{Clock, Pin};

/// An output pin set to a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Event {
    pub at_ns: u64,
    pub pin: Pin,
    pub high: bool,
}

/// A single failure of a pin, at the `nth` time (from 1) that it is set to this level, or read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Failure {
    pub pin: Pin,
    pub high: bool,
    pub nth: u64,
}

#[derive(Debug, Default)]
pub(crate) struct State {
    pub now_ns: u64,
    pub log: Vec<Event>,
    /// Times that a look at the clock takes, ns, one and the other by turns.
    pub look_ns: [u64; 2],
    /// Failures that are still to strike.
    pub failures: Vec<Failure>,
    /// Steps counted by rising edges, signed. A high direction pin is forward.
    pub rotor: i64,
    /// Positions at which the index sensor's pin is high.
    pub sensor: Option<core::ops::Range<i64>>,
    levels: [Option<bool>; 4],
    looks: usize,
}

impl State {
    /// Returns true if the failure strikes now.
    fn fails(&mut self, pin: Pin, high: bool) -> Result<(), ErrorKind> {
        let same = |failure: &&mut Failure| (failure.pin, failure.high) == (pin, high);
        if let Some(failure) = self.failures.iter_mut().find(same) {
            failure.nth -= 1;
            if failure.nth == 0 {
                self.failures.retain(|failure| failure.nth > 0);
                return Err(ErrorKind::Other);
            }
        }
        Ok(())
    }

    /// Returns the level to which a pin was set last.
    pub(crate) fn level(&self, pin: Pin) -> Option<bool> {
        self.levels[pin as usize]
    }
}

/// The shared time line. As a delay it lets time pass, and as a clock it counts microseconds.
#[derive(Debug, Clone, Default)]
pub(crate) struct Bench(Rc<RefCell<State>>);

impl Bench {
    pub(crate) fn state(&self) -> RefMut<'_, State> {
        self.0.borrow_mut()
    }

    /// Returns the step, direction, enable and index pins.
    pub(crate) fn wires(&self) -> [Wire; 4] {
        [Pin::Step, Pin::Direction, Pin::Enable, Pin::Index].map(|pin| Wire { pin, bench: self.clone() })
    }

    pub(crate) fn tick(&self) -> u64 {
        self.state().now_ns / 1000
    }

    pub(crate) fn wait_until(&self, tick: u64) {
        let mut state = self.state();
        state.now_ns = state.now_ns.max(1000 * tick);
    }

    /// Returns the times at which the step pin rose, ns.
    pub(crate) fn steps_ns(&self) -> Vec<u64> {
        let state = self.state();
        let rises = state.log.iter().filter(|event| event.pin == Pin::Step && event.high);
        rises.map(|event| event.at_ns).collect()
    }

    /// Returns the times between the steps, ns.
    pub(crate) fn gaps_ns(&self) -> Vec<u64> {
        self.steps_ns().windows(2).map(|pair| pair[1] - pair[0]).collect()
    }
}

impl DelayNs for Bench {
    fn delay_ns(&mut self, ns: u32) {
        self.state().now_ns += u64::from(ns);
    }
}

impl Clock for Bench {
    fn now(&mut self) -> u64 {
        let mut state = self.state();
        state.looks += 1;
        state.now_ns += state.look_ns[state.looks % 2];
        state.now_ns / 1000
    }
}

#[derive(Debug)]
pub(crate) struct Wire {
    pin: Pin,
    bench: Bench,
}

impl Wire {
    fn set(&mut self, high: bool) -> Result<(), ErrorKind> {
        let mut state = self.bench.state();
        state.fails(self.pin, high)?;
        let rises = high && state.level(self.pin) != Some(true);
        let event = Event { at_ns: state.now_ns, pin: self.pin, high };
        state.log.push(event);
        state.levels[self.pin as usize] = Some(high);
        if self.pin == Pin::Step && rises {
            state.rotor += if state.level(Pin::Direction) == Some(true) { 1 } else { -1 };
        }
        Ok(())
    }
}

impl ErrorType for Wire {
    type Error = ErrorKind;
}

impl OutputPin for Wire {
    fn set_low(&mut self) -> Result<(), ErrorKind> {
        self.set(false)
    }

    fn set_high(&mut self) -> Result<(), ErrorKind> {
        self.set(true)
    }
}

impl InputPin for Wire {
    fn is_high(&mut self) -> Result<bool, ErrorKind> {
        let mut state = self.bench.state();
        state.fails(self.pin, true)?;
        Ok(state.sensor.as_ref().is_some_and(|sensor| sensor.contains(&state.rotor)))
    }

    fn is_low(&mut self) -> Result<bool, ErrorKind> {
        Ok(!self.is_high()?)
    }
}
