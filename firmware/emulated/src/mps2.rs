//! The parts of the board that all axes share.

use pump_node::Board;

use crate::{axis_pins, step_timer};

/// Instructions of the emulated processor in a us, where each takes 8 ns (`-icount shift=3`). A real board is slower,
/// so its waits are longer.
const CYCLES_PER_US: u32 = 125;

/// Timer and emergency stop of the board.
#[derive(Debug)]
pub(crate) struct Mps2;

impl Board for Mps2 {
    #[inline(always)]
    fn now(&mut self) -> u64 {
        step_timer::now()
    }

    #[inline(always)]
    fn wait_until(&mut self, tick: u64) {
        step_timer::wait_until(tick);
    }

    #[inline(always)]
    fn wait_ns(&mut self, ns: u32) {
        cortex_m::asm::delay(ns * CYCLES_PER_US / 1_000);
    }

    #[inline(always)]
    fn estop_is_pressed(&mut self) -> bool {
        axis_pins::estop_is_pressed()
    }
}
