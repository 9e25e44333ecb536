//! What turns a motor.

mod drive;
mod grbl;
mod sim;

pub use drive::{Abilities, Disturbance, Drive, DriveError, DriveFault, DriveLimits, Gate, Sought};
pub use grbl::Grbl;
pub use sim::Sim;
