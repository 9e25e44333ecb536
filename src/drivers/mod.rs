//! What turns the motor.

mod sim;

pub use sim::Sim;
