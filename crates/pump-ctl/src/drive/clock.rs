//! Time for the blocking driver.

/// A free-running timer. `embedded-hal` 1.0 has none.
pub trait Clock {
    /// Ticks since some time in the past; never falls.
    fn now(&mut self) -> u64;
}
