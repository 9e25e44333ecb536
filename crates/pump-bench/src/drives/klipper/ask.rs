//! The question to a serial port: is a board with the Klipper firmware there? Nothing moves, and no board is taken.

use std::path::Path;
use std::time::Duration;

use super::board::Commands;
use super::board_pins::BoardPins;
use super::error::KlipperError;
use super::link::{Link, Place};
use crate::drives::wire::BoardPort;
use crate::drives::{DriveError, StopRequest};

/// Longest wait for a first answer. A board answers within milliseconds, and a port that was just opened may lose some
/// bytes.
const LIMIT: Duration = Duration::from_secs(1);

/// Name of the firmware.
const APP: &str = "Klipper";

/// Board that answers, as its dictionary tells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::drives) struct Identity {
    /// Microcontroller of the board. Empty if the firmware does not tell it.
    pub(in crate::drives) chip: String,
    /// Version of the firmware.
    pub(in crate::drives) version: String,
    /// Pins of the board.
    pub(in crate::drives) pins: BoardPins,
}

/// Asks the port for a board at `baud`: a second for a first answer, and the time that the dictionary takes. Returns
/// who it is.
pub(in crate::drives) fn ask(port: &Path, baud: u32, stop: &StopRequest) -> Result<Identity, DriveError> {
    let wire = BoardPort::open(Some(port), baud).map_err(KlipperError::from)?;
    let place = Place { port: port.to_owned(), baud };
    let mut link = Link::new(Box::new(wire), place, stop.clone());
    link.connect(LIMIT)?;
    let dictionary = link.identify()?;
    if let Some(app) = dictionary.app().filter(|app| *app != APP) {
        let (port, app) = (port.to_owned(), app.to_owned());
        return Err(KlipperError::OtherFirmware { port, app }.into());
    }
    // A build without a command that this driver needs is told before anybody sets a pump up at it.
    Commands::of(&dictionary).map_err(KlipperError::from)?;
    let chip = dictionary.constant_text("MCU").unwrap_or_default();
    let version = dictionary.version().to_owned();
    Ok(Identity { chip, version, pins: BoardPins::new(dictionary) })
}
