//! The drives that a pump file may name.

use super::drive::Abilities;
use super::{grbl, sim};
use crate::pump_file::DriverName;

/// What a driver can do, whatever device it finds.
pub fn abilities(driver: DriverName) -> Abilities {
    match driver {
        DriverName::Sim => sim::ABILITIES,
        DriverName::Grbl => grbl::ABILITIES,
    }
}
