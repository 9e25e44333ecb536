//! The parts of the board that all axes share.

use pump_node::{Board, Edge};

use crate::{axis_pins, step_timer};

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
    fn set_steps(&mut self, edge: Edge) {
        axis_pins::set_steps(edge);
    }

    #[inline(always)]
    fn estop_is_pressed(&mut self) -> bool {
        axis_pins::estop_is_pressed()
    }
}
