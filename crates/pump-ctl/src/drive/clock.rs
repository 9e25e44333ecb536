//! The clock of the blocking driver.

/// A free-running timer. `embedded-hal` 1.0 has none.
pub trait Clock {
    /// Returns the ticks since some time in the past. The count never falls.
    fn now(&mut self) -> u64;
}

impl<T: Clock + ?Sized> Clock for &mut T {
    fn now(&mut self) -> u64 {
        T::now(self)
    }
}
