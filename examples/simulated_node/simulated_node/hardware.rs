//! Pins and motors in software.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pump_node::{Board, Edge, Levels, Pins};

/// Ticks per second of the board's timer: one is 1 us.
pub(super) const TICK_HZ: u32 = 1_000_000;

#[derive(Debug, Clone, Copy, Default)]
struct Motor {
    levels: Option<Levels>,
    count: i64,
    /// Tick of its first step.
    first_rise: Option<u64>,
}

#[derive(Debug, Default)]
struct State {
    now: u64,
    stray: u32,
    motors: [Motor; 4],
    /// True while the emergency stop is pressed.
    estop: bool,
    /// True for each axis whose driver reports a fault.
    faults: [bool; 4],
    /// Steps from one index mark to the next of each axis that has a sensor.
    index_steps: [Option<u32>; 4],
    /// True for each axis whose stepper driver's output is high in a fault.
    fault_high: [bool; 4],
    /// True once somebody has pressed the board's reset, until it is taken.
    reset: bool,
    /// True while the cable to the computer is pulled.
    pulled: bool,
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

    /// Connects index sensors, each active once in so many steps of its axis.
    pub(super) fn sense_index(&self, index_steps: [Option<u32>; 4]) {
        self.state().index_steps = index_steps;
    }

    /// Connects stepper drivers whose outputs are high in a fault.
    pub(super) fn report_high(&self, fault_high: [bool; 4]) {
        self.state().fault_high = fault_high;
    }

    /// Does what a person's hand does at the board. The words are those of [`super::HANDS`].
    pub(super) fn touch(&self, words: &str) -> Result<(), String> {
        let words: Vec<_> = words.split_whitespace().collect();
        let axis = |name: &str| {
            let place = ["X", "Y", "Z", "A"].iter().position(|axis| axis.eq_ignore_ascii_case(name));
            place.ok_or(format!("`{name}` is none of the axes X, Y, Z and A"))
        };
        let mut state = self.state();
        match words.as_slice() {
            [] => {}
            ["estop"] => state.estop = true,
            ["release"] => state.estop = false,
            ["fault", name] => state.faults[axis(name)?] = true,
            ["mend", name] => state.faults[axis(name)?] = false,
            ["reset"] => state.reset = true,
            ["pull"] => state.pulled = true,
            ["plug"] => state.pulled = false,
            _ => return Err(super::HANDS.to_owned()),
        }
        Ok(())
    }

    /// Returns true if somebody has pressed the board's reset. Its pins are inputs then.
    pub(super) fn take_reset(&self) -> bool {
        let mut state = self.state();
        let reset = std::mem::take(&mut state.reset);
        if reset {
            state.motors.iter_mut().for_each(|motor| motor.levels = None);
        }
        reset
    }

    /// Returns true while the cable to the computer is pulled.
    pub(super) fn is_pulled(&self) -> bool {
        self.state().pulled
    }

    /// Returns the tick of each motor's first step.
    pub(super) fn first_rises(&self) -> [Option<u64>; 4] {
        self.state().motors.map(|motor| motor.first_rise)
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
        self.state().estop
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
        let now = state.now;
        let Some(motor) = state.motors.get_mut(self.axis) else { return };
        let Some(levels) = &mut motor.levels else { return };
        let before = *levels;
        change(levels);
        if levels.step && !before.step {
            // A motor of the usual polarity: it has current while enable is low, and a high direction is forward.
            state.stray += u32::from(levels.enable);
            motor.count += if levels.direction { 1 } else { -1 };
            motor.first_rise.get_or_insert(now);
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
        let state = self.hardware.state();
        let (Some(motor), Some(Some(steps))) =
            (state.motors.get(self.axis), state.index_steps.get(self.axis))
        else {
            return false;
        };
        // The mark comes half a way after the start, and is a hundredth of the way wide.
        let way = i64::from(*steps).max(2);
        (motor.count - way / 2).rem_euclid(way) < (way / 100).max(1)
    }

    fn driver_fault_is_high(&mut self) -> bool {
        let state = self.hardware.state();
        let at = |levels: &[bool; 4]| levels.get(self.axis).copied().unwrap_or(false);
        at(&state.faults) == at(&state.fault_high)
    }
}
