//! The TMC2209, a silent stepper driver with registers behind one wire, which the board's software serves.
//!
//! Sources: TMC2209 datasheet, rev. 1.09, chapters 4 (the wire), 5 (the registers) and 9 (the current);
//! Klipper3d/klipper, `src/tmcuart.c`, for what the board makes of the bits that it is given.
//!
//! - `frames`: bytes as bits on the wire.
//! - `datagram`: reads, writes and answers with their checksum.
//! - `register`: numbers and bits of the registers.
//! - `current`: motor current and its scale.
//! - `settings`: what a motor needs, as writes of registers.
//! - `status`: faults of a driver in words.
//! - `driver`: reads and confirmed writes over a [`TmcLine`].
//! - `inquiry`: questions for the state of a driver whose motor turns, by a line that nobody may wait for.

mod current;
mod datagram;
mod driver;
mod error;
mod frames;
mod inquiry;
mod register;
mod settings;
mod status;
#[cfg(test)]
mod tests;

pub(super) use driver::{Tmc, TmcLine, bit_ticks};
pub use error::TmcError;
pub(super) use inquiry::{ANSWER_LEN, Inquiry};
pub(super) use settings::{Chopper, TmcSettings};
pub(super) use status::TmcStatus;
