//! The registry of drives that a pump file may name. A new protocol is a folder beside this file, and a line
//! in each function here.

use pump_ctl::plan::Phase;
use pump_model::Pump;

use super::drive::{Abilities, Drive, DriveError};
use super::{grbl, sim};
use crate::pump_file::{DriveTable, DriverName, PumpFile};

/// Returns the abilities of a driver, whatever device it finds.
pub fn abilities(driver: DriverName) -> Abilities {
    match driver {
        DriverName::Sim => sim::ABILITIES,
        DriverName::Grbl => grbl::ABILITIES,
    }
}

/// Returns the angle of a rotor without a record. A simulated rotor stands at 0 deg, a real one anywhere in
/// its pitch.
pub fn fresh(driver: DriverName, pitch_rad: f64) -> Phase {
    match driver {
        DriverName::Sim => Phase::known(0.0),
        DriverName::Grbl => Phase::unknown(pitch_rad),
    }
}

/// Opens the drive that `table` names, for the pump of `file` with its `model`. A device's settings are
/// written only if `configure` allows it.
///
/// # Errors
///
/// [`DriveError`] if the device is missing, in use, or not fit for the pump.
pub fn open<'a>(
    table: &DriveTable,
    file: &PumpFile,
    model: &'a Pump,
    configure: bool,
) -> Result<Box<dyn Drive + 'a>, DriveError> {
    Ok(match table.driver {
        DriverName::Sim => Box::new(sim::Sim::new(model)),
        DriverName::Grbl => Box::new(grbl::Grbl::open(table, &file.motor, configure)?),
    })
}
