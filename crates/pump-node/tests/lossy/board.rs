//! A board in software: pins that remember their edges, and a timer that is told the time.

use std::cell::RefCell;
use std::rc::Rc;

use pump_node::{Board, Edge, Levels, Pins};

/// The pins of an axis and the motor behind them. A motor keeps its place through a reset of the board.
#[derive(Debug, Clone, Default)]
pub(crate) struct AxisPins {
    pub(crate) outputs: bool,
    pub(crate) levels: Option<Levels>,
    /// Steps that the motor has made, signed.
    pub(crate) count: i64,
    /// Ticks at which the step pin rose since the board was switched on.
    pub(crate) rises: Vec<u64>,
    /// Rises of a motor without current or with pins that are inputs.
    pub(crate) stray: u32,
}

#[derive(Debug, Default)]
pub(crate) struct Hardware {
    pub(crate) now: u64,
    pub(crate) estop: bool,
    pub(crate) axes: [AxisPins; 4],
}

#[derive(Debug, Clone)]
pub(crate) struct SharedHardware(pub(crate) Rc<RefCell<Hardware>>);

impl Board for SharedHardware {
    fn now(&mut self) -> u64 {
        self.0.borrow().now
    }

    fn wait_until(&mut self, tick: u64) {
        let now = &mut self.0.borrow_mut().now;
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
        self.0.borrow().estop
    }
}

#[derive(Debug)]
pub(crate) struct SimulatedPins(pub(crate) SharedHardware, pub(crate) usize);

impl SimulatedPins {
    fn change(&mut self, change: impl FnOnce(&mut Levels)) {
        let hardware = &mut *self.0.0.borrow_mut();
        let axis = &mut hardware.axes[self.1];
        let Some(levels) = &mut axis.levels else {
            axis.stray += 1;
            return;
        };
        let before = *levels;
        change(levels);
        if levels.step && !before.step {
            // Enable is active low, and a high direction pin is forward. The emergency stop cuts enable.
            if levels.enable || hardware.estop || !axis.outputs {
                axis.stray += 1;
            } else {
                axis.count += if levels.direction { 1 } else { -1 };
            }
            axis.rises.push(hardware.now);
        }
    }
}

impl Pins for SimulatedPins {
    fn make_outputs(&mut self, levels: Levels) {
        let axis = &mut self.0.0.borrow_mut().axes[self.1];
        axis.levels = Some(levels);
        axis.outputs = true;
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
        false
    }

    fn driver_fault_is_high(&mut self) -> bool {
        true
    }
}
