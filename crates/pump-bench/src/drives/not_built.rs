//! The drive of a board, in a program that is built without it.

#[cfg(not(feature = "klipper"))]
use super::drive::Disturbance;
use super::drive::Drive;
#[cfg(not(feature = "grbl"))]
use super::drive::DriveLimits;
use super::error::DriveError;
use super::opening::Opening;
#[cfg(not(all(feature = "grbl", feature = "node")))]
use super::stop_request::StopRequest;
#[cfg(all(feature = "grbl", feature = "node"))]
use crate::pump_file::KlipperTable;
use crate::pump_file::{DriveTable, PumpFile};

/// Refuses the board.
pub(super) fn open(
    table: &DriveTable,
    _file: &PumpFile,
    _opening: &Opening,
) -> Result<Box<dyn Drive>, DriveError> {
    Err(DriveError::NotBuilt { driver: table.driver.as_str() })
}

/// Refuses the board.
#[cfg(not(feature = "grbl"))]
pub(super) fn recorded_limits(
    table: &DriveTable,
    _opening: &Opening,
    _step_rad: f64,
) -> Result<Option<DriveLimits>, DriveError> {
    Err(DriveError::NotBuilt { driver: table.driver.as_str() })
}

/// Returns nothing: a program without boards has no record of them.
#[cfg(not(feature = "klipper"))]
pub(super) fn told_by_record(_table: &DriveTable, _opening: &Opening) -> Option<Disturbance> {
    None
}

/// Returns the error as it is: a program with one kind of board, or none, asks for no other.
#[cfg(not(all(feature = "grbl", feature = "node")))]
pub(super) fn told_apart(error: DriveError, _table: &DriveTable, _stop: &StopRequest) -> DriveError {
    error
}

/// Pins of a board with the Klipper firmware. A program without its driver finds no such board.
#[cfg(all(feature = "grbl", feature = "node"))]
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BoardPins {}

#[cfg(all(feature = "grbl", feature = "node"))]
impl BoardPins {
    /// Returns nothing, since there are no such pins.
    pub(super) fn check(&self, _table: &KlipperTable) -> Result<(), DriveError> {
        match *self {}
    }
}
