//! The parts of the board that all axes share.

use pump_node::Board;

use crate::axis_pins::{ESTOP, is_high};
use crate::step_timer;

/// Cycles of the processor in a µs.
const CYCLES_PER_US: u32 = 125;

/// Timer and emergency stop of the board.
#[derive(Debug)]
pub(crate) struct Pico;

impl Board for Pico {
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
        is_high(1 << ESTOP)
    }
}
