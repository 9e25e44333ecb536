//! Pins, motors and the timer of a board in software.

use std::sync::{Arc, Mutex};

use pump_node::{Board, Edge, Levels, Pins};

/// Ticks per second of the board's timer.
pub(crate) const TICK_HZ: u32 = 1_000_000;

/// Pins of an axis, and the motor behind them, which keeps its place through a reset of the board.
#[derive(Debug, Clone, Default)]
pub(crate) struct Motor {
    pub(super) levels: Option<Levels>,
    /// Steps that the motor has made, signed.
    pub(crate) count: i64,
    /// Ticks at which the step pin rose.
    pub(crate) rises: Vec<u64>,
    /// Rises while the motor has no current.
    pub(crate) stray: u32,
}

#[derive(Debug, Default)]
pub(crate) struct Hardware {
    pub(super) now: u64,
    pub(crate) estop: bool,
    /// True while every stepper driver reports a fault.
    pub(crate) has_driver_fault: bool,
    /// Count of the motor at which the index sensor becomes active.
    pub(crate) index_at: Option<i64>,
    pub(crate) motors: [Motor; 4],
}

/// Hardware that a board and its pins share.
#[derive(Debug, Clone, Default)]
pub(super) struct Shared(pub(super) Arc<Mutex<Hardware>>);

impl Board for Shared {
    fn now(&mut self) -> u64 {
        self.0.lock().unwrap().now
    }

    fn wait_until(&mut self, tick: u64) {
        let now = &mut self.0.lock().unwrap().now;
        *now = tick.max(*now);
    }

    fn set_steps(&mut self, edge: Edge) {
        for axis in 0..4 {
            for (pins, high) in [(edge.high, true), (edge.low, false)] {
                if pins & 1 << axis != 0 {
                    SimulatedPins(self.clone(), axis).change(|levels| levels.step = high);
                }
            }
        }
    }

    fn estop_is_pressed(&mut self) -> bool {
        self.0.lock().unwrap().estop
    }
}

/// Pins of one axis.
#[derive(Debug)]
pub(super) struct SimulatedPins(pub(super) Shared, pub(super) usize);

impl SimulatedPins {
    fn change(&mut self, change: impl FnOnce(&mut Levels)) {
        let hardware = &mut *self.0.0.lock().unwrap();
        let motor = &mut hardware.motors[self.1];
        let levels = motor.levels.as_mut().unwrap();
        let before = *levels;
        change(levels);
        if levels.step && !before.step {
            // Enable is active low, and a high direction pin is forward. The emergency stop cuts enable.
            motor.stray += u32::from(levels.enable || hardware.estop);
            motor.count += if levels.direction { 1 } else { -1 };
            motor.rises.push(hardware.now);
        }
    }
}

impl Pins for SimulatedPins {
    fn make_outputs(&mut self, levels: Levels) {
        self.0.0.lock().unwrap().motors[self.1].levels = Some(levels);
    }

    fn step_pin(&self) -> u32 {
        1 << self.1
    }

    fn set_direction(&mut self, high: bool) {
        self.change(|levels| levels.direction = high);
    }

    fn set_enable(&mut self, high: bool) {
        self.change(|levels| levels.enable = high);
    }

    fn index_is_high(&mut self) -> bool {
        let hardware = self.0.0.lock().unwrap();
        hardware.index_at.is_some_and(|at| hardware.motors[self.1].count >= at)
    }

    fn driver_fault_is_high(&mut self) -> bool {
        !self.0.0.lock().unwrap().has_driver_fault
    }
}
