//! What turns a motor.

mod drive;
mod sim;

pub use drive::{Abilities, Disturbance, Drive, DriveError, DriveFault, DriveLimits, Found, Gate};
pub use sim::Sim;
