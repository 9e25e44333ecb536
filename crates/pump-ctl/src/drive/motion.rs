//! What turns the rotor.

use super::error::StepFault;

/// A motor that makes steps: pins, a bus, a simulation, an axis of another stack.
pub trait Motion {
    /// Why it fails.
    type Error;

    /// Makes one step, 1 forward or -1 in reverse. Returns once the next step may follow.
    fn step(&mut self, direction: i8) -> Result<(), StepFault<Self::Error>>;

    /// Energises the motor, so that it holds its angle. Returns once it may step.
    fn enable(&mut self) -> Result<(), Self::Error>;

    /// Lets go of the rotor. Its angle is then no longer certain.
    fn disable(&mut self) -> Result<(), Self::Error>;

    /// Whether the rotor stands in its index sensor; `None` without a sensor.
    fn index(&mut self) -> Result<Option<bool>, Self::Error> {
        Ok(None)
    }
}
