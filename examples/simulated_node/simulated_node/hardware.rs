//! Pins and motors in software.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pump_node::{Board, Edge, Levels, Pins};

/// Ticks per second of the board's timer: one is 1 us.
pub(super) const TICK_HZ: u32 = 1_000_000;

#[derive(Debug, Clone, Copy, Default)]
struct Motor {
    levels: Option<Levels>,
    count: i64,
}

#[derive(Debug, Default)]
struct State {
    now: u64,
    stray: u32,
    motors: [Motor; 4],
}

/// Timer, pins and motors of a board. Clones are the same board.
#[derive(Debug, Clone, Default)]
pub(super) struct Hardware(Arc<Mutex<State>>);

impl Hardware {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn now(&self) -> u64 {
        self.state().now
    }

    pub(super) fn set_now(&self, now: u64) {
        self.state().now = now;
    }

    /// Returns the steps of each motor, and the rises of step pins whose motors had no current.
    pub(super) fn counts(&self) -> ([i64; 4], u32) {
        let state = self.state();
        (state.motors.map(|motor| motor.count), state.stray)
    }
}

impl Board for Hardware {
    fn now(&mut self) -> u64 {
        Self::now(self)
    }

    fn wait_until(&mut self, tick: u64) {
        let mut state = self.state();
        state.now = state.now.max(tick);
    }

    fn set_steps(&mut self, edge: Edge) {
        for axis in 0..4 {
            for (pins, high) in [(edge.high, true), (edge.low, false)] {
                if pins & 1 << axis != 0 {
                    SimulatedPins::new(self, axis).change(|levels| levels.step = high);
                }
            }
        }
    }

    fn estop_is_pressed(&mut self) -> bool {
        false
    }
}

/// Pins of one axis.
#[derive(Debug)]
pub(super) struct SimulatedPins {
    hardware: Hardware,
    axis: usize,
}

impl SimulatedPins {
    pub(super) fn new(hardware: &Hardware, axis: usize) -> Self {
        Self { hardware: hardware.clone(), axis }
    }

    fn change(&mut self, change: impl FnOnce(&mut Levels)) {
        let state = &mut *self.hardware.state();
        let Some(motor) = state.motors.get_mut(self.axis) else { return };
        let Some(levels) = &mut motor.levels else { return };
        let before = *levels;
        change(levels);
        if levels.step && !before.step {
            // A motor of the usual polarity: it has current while enable is low, and a high direction is forward.
            state.stray += u32::from(levels.enable);
            motor.count += if levels.direction { 1 } else { -1 };
        }
    }
}

impl Pins for SimulatedPins {
    fn make_outputs(&mut self, levels: Levels) {
        if let Some(motor) = self.hardware.state().motors.get_mut(self.axis) {
            motor.levels = Some(levels);
        }
    }

    fn step_pin(&self) -> u32 {
        1 << self.axis
    }

    fn set_direction(&mut self, high: bool) {
        self.change(|levels| levels.direction = high);
    }

    fn set_enable(&mut self, high: bool) {
        self.change(|levels| levels.enable = high);
    }

    fn index_is_high(&mut self) -> bool {
        false
    }

    fn driver_fault_is_high(&mut self) -> bool {
        true
    }
}
