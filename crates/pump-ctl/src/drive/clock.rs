//! The clock of the blocking driver.

/// A free-running timer. `embedded-hal` 1.0 has none.
pub trait Clock {
    /// Returns the ticks since some time in the past. The count never falls.
    fn now(&mut self) -> u64;
}
