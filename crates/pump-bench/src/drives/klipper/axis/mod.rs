//! One motor at a board, as the drive of a pump.

mod klipper;

pub use klipper::Klipper;
pub(in crate::drives) use klipper::open;
