//! What turns a motor.

mod drive;
pub mod grbl;
mod sim;

pub use drive::{Abilities, Disturbance, Drive, DriveError, DriveFault, DriveLimits, Gate, Sought};
pub use grbl::{Grbl, GrblError};
pub use sim::Sim;

use crate::pump_file::DriverName;

/// What a driver can do, whatever device it finds.
pub fn abilities(driver: DriverName) -> Abilities {
    match driver {
        DriverName::Sim => sim::ABILITIES,
        DriverName::Grbl => grbl::ABILITIES,
    }
}
