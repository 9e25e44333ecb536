//! What turns a motor.

mod drive;
pub mod grbl;
mod sim;

pub use drive::{Abilities, Disturbance, Drive, DriveError, DriveFault, DriveLimits, Found, Gate};
pub use grbl::{Grbl, GrblError};
pub use sim::Sim;
