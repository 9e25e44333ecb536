//! The seam to whatever turns the rotor.

use core::fmt::Debug;

use crate::step::Direction;

/// A motor that makes steps: pins, a bus, a simulation, an axis of another stack.
///
/// Only [`Self::step`] must be written. The other methods suit a motor that is always energised, has no index
/// sensor and makes no step that fails. `&mut T` is a motor too.
pub trait StepMotor {
    /// Error of the back end.
    type Error: Debug;

    /// Makes one step. Returns once the next step may follow.
    ///
    /// # Errors
    ///
    /// Fails with the back end's error. [`Self::made_its_step`] tells whether the step was made all the same.
    fn step(&mut self, direction: Direction) -> Result<(), Self::Error>;

    /// Returns true if the motor has made the step that failed with `error`. The position counts such a step.
    fn made_its_step(&self, error: &Self::Error) -> bool {
        let _ = error;
        false
    }

    /// Energises the motor, so that it holds its angle. Returns once it may step.
    ///
    /// # Errors
    ///
    /// Fails with the back end's error.
    fn enable(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Lets go of the motor. The rotor's angle is then no longer certain.
    ///
    /// # Errors
    ///
    /// Fails with the back end's error.
    fn disable(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Returns true if the rotor stands in its index sensor. Without a sensor the result is `None`.
    ///
    /// # Errors
    ///
    /// Fails with the back end's error.
    fn index(&mut self) -> Result<Option<bool>, Self::Error> {
        Ok(None)
    }
}

impl<T: StepMotor + ?Sized> StepMotor for &mut T {
    type Error = T::Error;

    fn step(&mut self, direction: Direction) -> Result<(), T::Error> {
        T::step(self, direction)
    }

    fn made_its_step(&self, error: &T::Error) -> bool {
        T::made_its_step(self, error)
    }

    fn enable(&mut self) -> Result<(), T::Error> {
        T::enable(self)
    }

    fn disable(&mut self) -> Result<(), T::Error> {
        T::disable(self)
    }

    fn index(&mut self) -> Result<Option<bool>, T::Error> {
        T::index(self)
    }
}
