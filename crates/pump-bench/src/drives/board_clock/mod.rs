//! The board's clock by the computer's: where it stands, how fast it runs, and how far either may be wrong.

mod board_clock;
mod error;
mod region;
mod sample;
mod shared_clock;
#[cfg(test)]
mod tests;

pub(super) use board_clock::{BoardClock, ClockBounds};
pub use error::ClockError;
pub(super) use sample::Reading;
pub(super) use shared_clock::SharedClock;
