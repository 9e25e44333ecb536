//! The registry of drives that a pump file may name. A new protocol is a folder beside this file, and a line
//! in each function here.

use pump_model::Pump;

use super::abilities::Abilities;
use super::drive::{Disturbance, Drive, DriveLimits};
use super::error::DriveError;
#[cfg(all(feature = "grbl", feature = "node"))]
use super::find;
#[cfg(feature = "grbl")]
use super::grbl;
use super::identity::Identity;
#[cfg(feature = "klipper")]
use super::klipper;
#[cfg(feature = "node")]
use super::node;
#[cfg(not(all(feature = "grbl", feature = "node")))]
use super::not_built as find;
#[cfg(not(feature = "grbl"))]
use super::not_built as grbl;
#[cfg(not(feature = "klipper"))]
use super::not_built as klipper;
#[cfg(not(feature = "node"))]
use super::not_built as node;
use super::opening::Opening;
use super::sim;
use crate::pump_file::{DriveTable, DriverName, PumpFile};

/// Returns the identity of a drive, whatever device it finds.
pub(crate) fn identity(driver: DriverName) -> Identity {
    let (is_simulated, abilities) = match driver {
        DriverName::Sim => (true, sim::ABILITIES),
        DriverName::Grbl => (false, Abilities::GRBL),
        DriverName::Node => (false, Abilities::NODE),
        DriverName::Klipper => (false, Abilities::KLIPPER),
    };
    Identity { id: driver.as_str().to_owned(), is_simulated, abilities }
}

/// Returns the limits that the device of `table` had the last time, by its record. `None` without a record.
///
/// # Errors
///
/// [`DriveError`] if the record cannot be read.
pub(crate) fn recorded_limits(
    table: &DriveTable,
    opening: &Opening,
    step_rad: f64,
) -> Result<Option<DriveLimits>, DriveError> {
    match table.driver {
        DriverName::Grbl => grbl::recorded_limits(table, opening, step_rad),
        DriverName::Sim | DriverName::Node | DriverName::Klipper => Ok(None),
    }
}

/// Returns what has befallen the motor of `table` since it was met last, by the records of its board, which another
/// pump may have had reset meanwhile. The next meeting tells it.
pub(crate) fn told_by_record(table: &DriveTable, opening: &Opening) -> Option<Disturbance> {
    match table.driver {
        DriverName::Klipper => klipper::told_by_record(table, opening),
        DriverName::Sim | DriverName::Grbl | DriverName::Node => None,
    }
}

/// Opens the drive that `table` names, for the pump of `file` with its `model`, on the terms of `opening`.
///
/// # Errors
///
/// [`DriveError`] if the device is missing, in use, or not fit for the pump.
pub(crate) fn open<'a>(
    table: &DriveTable,
    file: &PumpFile,
    model: &'a Pump,
    opening: &Opening,
) -> Result<Box<dyn Drive + 'a>, DriveError> {
    let opened: Result<Box<dyn Drive>, _> = match table.driver {
        DriverName::Sim => return Ok(Box::new(sim::Sim::new(model))),
        DriverName::Grbl => grbl::open(table, file, opening),
        DriverName::Node => node::open(table, file, opening),
        DriverName::Klipper => klipper::open(table, file, opening),
    };
    opened.map_err(|error| match is_of_record(&error, opening) {
        true => error,
        false => find::told_apart(error, table, &opening.stop),
    })
}

/// Returns true for the silence of a node that is on record as the pump's board: its cable or its power is the first to
/// look at, and nobody waits for other kinds of boards to be asked.
#[cfg(feature = "node")]
fn is_of_record(error: &DriveError, opening: &Opening) -> bool {
    let DriveError::Device(error) = error else { return false };
    let is_silent = matches!(error.downcast_ref(), Some(node::NodeError::Silent { .. }));
    is_silent && opening.settings_record.as_ref().is_some_and(|record| record.exists())
}

#[cfg(not(feature = "node"))]
fn is_of_record(_error: &DriveError, _opening: &Opening) -> bool {
    false
}
