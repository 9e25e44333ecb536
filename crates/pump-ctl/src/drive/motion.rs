//! The seam to whatever turns the rotor.

use super::error::StepFault;

/// A motor that makes steps: pins, a bus, a simulation, an axis of another stack.
pub trait Motion {
    /// Error of the back end.
    type Error;

    /// Makes one step, 1 forward or -1 in reverse. Returns once the next step may follow.
    ///
    /// # Errors
    ///
    /// Fails with the back end's error, and tells whether the motor has made the step all the same.
    fn step(&mut self, direction: i8) -> Result<(), StepFault<Self::Error>>;

    /// Energises the motor, so that it holds its angle. Returns once it may step.
    ///
    /// # Errors
    ///
    /// Fails with the back end's error.
    fn enable(&mut self) -> Result<(), Self::Error>;

    /// Lets go of the motor. The rotor's angle is then no longer certain.
    ///
    /// # Errors
    ///
    /// Fails with the back end's error.
    fn disable(&mut self) -> Result<(), Self::Error>;

    /// Returns true if the rotor stands in its index sensor. Without a sensor the result is `None`.
    ///
    /// # Errors
    ///
    /// Fails with the back end's error.
    fn index(&mut self) -> Result<Option<bool>, Self::Error> {
        Ok(None)
    }
}
