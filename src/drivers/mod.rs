//! What turns a motor.

mod drive;
mod sim;

pub use drive::{Drive, DriveError, DriveFault, Gate};
pub use sim::Sim;
