//! The drives that turn a motor.

mod drive;
pub mod grbl;
pub mod registry;
mod sim;

pub use drive::{Abilities, Disturbance, Drive, DriveError, DriveFault, DriveLimits, Gate, Sought};
pub use grbl::{Grbl, GrblError};
pub use sim::Sim;
