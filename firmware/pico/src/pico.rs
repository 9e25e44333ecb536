//! The parts of the board that all axes share.

use pump_node::{Board, Edge};

use crate::axis_pins::{ESTOP, is_high, set_steps};
use crate::step_timer;

/// Timer and emergency stop of the board.
#[derive(Debug)]
pub(crate) struct Pico;

impl Board for Pico {
    #[inline(always)]
    fn now(&mut self) -> u64 {
        step_timer::now()
    }

    #[inline(always)]
    fn since(&mut self, tick: u64) -> u32 {
        step_timer::low().wrapping_sub(tick as u32)
    }

    #[inline(always)]
    fn wait_until(&mut self, tick: u64) {
        step_timer::wait_until(tick);
    }

    #[inline(always)]
    fn set_steps(&mut self, edge: Edge) {
        set_steps(edge);
    }

    #[inline(always)]
    fn estop_is_pressed(&mut self) -> bool {
        is_high(1 << ESTOP)
    }
}
