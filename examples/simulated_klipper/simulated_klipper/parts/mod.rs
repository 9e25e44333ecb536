//! The parts that a host configures on the board.
//!
//! Times are ticks of the board's clock since it was switched on, in 64 bits. The figures are those of the firmware's
//! own sources (src/stepper.c, src/gpiocmds.c, src/trsync.c, src/endstop.c, src/tmcuart.c of Klipper3d/klipper).

mod digital_out;
mod driver;
mod endstop;
mod stepper;
mod trigger;
mod uart;

pub(super) use digital_out::DigitalOut;
pub(super) use driver::{Driver, State};
pub(super) use endstop::{Endstop, Homing};
pub(super) use stepper::{Made, Move, Stepper, widened};
pub(super) use trigger::{Trigger, TriggerEvent};
pub(super) use uart::Uart;
