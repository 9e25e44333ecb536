//! The other pumps of the configuration that boards turn: two pumps have no axis in common.

use std::path::{Path, PathBuf};

use super::answers::Answers;
use super::error::SetupError;
use crate::config::Config;
use crate::pump_file::{Axis, DriverName, PumpFile};

/// Pump of the configuration that an axis of a board turns.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Neighbour {
    /// Name of the pump in the configuration.
    pub name: String,
    /// Serial port of the board.
    pub port: PathBuf,
    /// Axis of the board.
    pub axis: Axis,
    /// Pin that makes the steps, at a board with the Klipper firmware.
    pub step_pin: Option<String>,
}

impl Neighbour {
    /// Returns the pumps of the configuration that boards turn, but the one of this name. A pump file that cannot be
    /// read is left out.
    pub fn all_but(config: &Config, name: &str) -> Vec<Self> {
        let pumps = config.pumps().iter().filter(|(other, _)| *other != name);
        let at_boards = pumps.filter_map(|(other, path)| {
            let file = PumpFile::read(path).ok().filter(|file| file.pump.id != name)?;
            let drive = file.drive.filter(|drive| drive.driver != DriverName::Sim)?;
            let step_pin = drive.klipper.map(|klipper| klipper.step.name);
            Some(Self { name: other.clone(), port: drive.port?, axis: drive.axis, step_pin })
        });
        at_boards.collect()
    }

    /// Returns true if the board is at this port, by this or another name of the device.
    pub fn is_at(&self, port: &Path) -> bool {
        let device = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        self.port == port || device(&self.port) == device(port)
    }
}

impl Answers {
    /// Refuses an axis of a board that turns another pump. An axis that nobody has said contradicts none.
    ///
    /// # Errors
    /// [`SetupError::Axis`] with the pump that has the axis.
    pub fn check_axis(&self, neighbours: &[Neighbour]) -> Result<(), SetupError> {
        let (Some(port), Some(axis)) = (&self.port, self.axis) else { return Ok(()) };
        // A Klipper board has no axes.
        if matches!(self.driver, Some(DriverName::Sim | DriverName::Klipper)) || self.socket.is_some() {
            return Ok(());
        }
        match neighbours.iter().find(|other| other.axis == axis && other.is_at(port)) {
            None => Ok(()),
            Some(other) => Err(SetupError::Axis { axis, port: port.clone(), name: other.name.clone() }),
        }
    }

    /// Refuses a socket of a board that turns another pump. A socket that nobody has said contradicts none.
    ///
    /// # Errors
    /// [`SetupError::Socket`] with the pump that has the socket.
    pub fn check_socket(&self, neighbours: &[Neighbour]) -> Result<(), SetupError> {
        let (Some(port), Some(socket)) = (&self.port, &self.socket) else { return Ok(()) };
        if self.driver != Some(DriverName::Klipper) {
            return Ok(());
        }
        let has_pin = |other: &&Neighbour| other.step_pin.as_deref() == Some(socket.step_pin());
        match neighbours.iter().filter(has_pin).find(|other| other.is_at(port)) {
            None => Ok(()),
            Some(other) => Err(SetupError::Socket {
                socket: socket.to_string(),
                port: port.clone(),
                name: other.name.clone(),
            }),
        }
    }
}
