//! Boards that are found by asking the ports: grbl boards, nodes, and boards with the Klipper firmware.

use std::error::Error as StdError;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use super::error::DriveError;
use super::grbl::{self, GrblError, ask_board};
#[cfg(feature = "klipper")]
use super::klipper::{self, BoardPins, KlipperError};
use super::known_board::{KnownBoard, RecordedPump};
#[cfg(not(feature = "klipper"))]
use super::not_built::BoardPins;
use super::opening::Opening;
use super::stop_request::StopRequest;
use super::{NodeError, node};
use crate::pump_file::{Axis, DriveTable, DriverName, KlipperTable};

/// Longest wait for a grbl board that a node's driver has asked before: it has started by then.
const STARTED: Duration = Duration::from_secs(2);

/// Board that was found at a port.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum FoundBoard {
    /// Board that speaks grbl's protocol.
    Grbl {
        /// State of the board, as `Idle`.
        state: String,
        /// Number of axes that it reports. It is 0 for a board that reports no position.
        axes: u8,
    },
    /// Board with this project's own firmware.
    Node {
        /// Number of the board. It is 0 if the firmware knows none.
        board: u64,
        /// Version of the firmware: major, minor, patch.
        firmware: [u16; 3],
        /// Number of axes.
        axes: u8,
    },
    /// Board with the Klipper firmware.
    Klipper {
        /// Microcontroller, as the firmware names it. Empty if it does not.
        chip: String,
        /// Version of the firmware.
        version: String,
        /// Pins of the board.
        pins: BoardPins,
    },
}

impl FoundBoard {
    /// Returns the axes of the board. Empty for a board that does not tell, and for one that has pins in their place.
    pub fn axes(&self) -> &'static [Axis] {
        match self {
            Self::Grbl { axes, .. } | Self::Node { axes, .. } => {
                Axis::ALL.get(..usize::from(*axes)).unwrap_or(Axis::ALL)
            }
            Self::Klipper { .. } => &[],
        }
    }

    /// Returns the number of the board, if it tells one.
    pub fn number(&self) -> Option<u64> {
        match self {
            Self::Node { board, .. } => Some(*board).filter(|board| *board != 0),
            Self::Grbl { .. } | Self::Klipper { .. } => None,
        }
    }

    /// Returns the other pumps on record that axes of this board turn, each with its axis. `opening` is that of a
    /// bench. A grbl board is known by the name that its port keeps.
    pub fn pumps_on_record(&self, port: &Path, opening: &Opening) -> Vec<(String, Axis)> {
        let found = self.marks(port, None, opening);
        let pumps = RecordedPump::of_board(&found, opening);
        pumps.into_iter().filter_map(|pump| Some((pump.pump, pump.board.axis?))).collect()
    }

    /// Puts this board on record for a pump that has not moved, so that another board at the port is refused. The
    /// pumps that `axis` turns by their records make place. Returns their names. A board without a number is on record
    /// from the pump's first motion on.
    ///
    /// # Errors
    ///
    /// [`DriveError::Device`] if the record cannot be written.
    pub fn expect(&self, port: &Path, axis: Axis, opening: &Opening) -> Result<Vec<String>, DriveError> {
        if self.number().is_none() {
            return Ok(Vec::new());
        }
        Ok(self.marks(port, Some(axis), opening).expect(opening).map_err(NodeError::from)?)
    }

    /// Returns the number of another board that the pump's record is of. `None` if either board tells none.
    pub fn other_on_record(&self, opening: &Opening) -> Option<u64> {
        let recorded = RecordedPump::named(opening.pump.as_deref()?, opening)?.board.number?;
        self.number().filter(|number| *number != recorded).map(|_| recorded)
    }

    fn marks(&self, port: &Path, axis: Option<Axis>, opening: &Opening) -> KnownBoard {
        KnownBoard { number: self.number(), axis, ..KnownBoard::at_port(Some(port), opening) }
    }

    /// Refuses the first pin of a table that the board lacks, or that its firmware uses itself. A board that has no
    /// pins by name refuses none.
    ///
    /// # Errors
    ///
    /// [`DriveError::Refused`] with the pin, and the pins that the board has.
    pub fn check_pins(&self, table: &KlipperTable) -> Result<(), DriveError> {
        match self {
            Self::Klipper { pins, .. } => pins.check(table),
            Self::Grbl { .. } | Self::Node { .. } => Ok(()),
        }
    }

    /// Returns the name of the board's driver.
    pub fn driver(&self) -> DriverName {
        match self {
            Self::Grbl { .. } => DriverName::Grbl,
            Self::Node { .. } => DriverName::Node,
            Self::Klipper { .. } => DriverName::Klipper,
        }
    }
}

impl Display for FoundBoard {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Grbl { state, .. } => write!(to, "a grbl board, {state}")?,
            Self::Node { board, firmware: [major, minor, patch], .. } => {
                let number = if *board == 0 { String::new() } else { format!(" {board:016x}") };
                write!(to, "a node{number}, firmware {major}.{minor}.{patch}")?;
            }
            Self::Klipper { chip, version, .. } => {
                let chip = if chip.is_empty() { String::new() } else { format!(" ({chip})") };
                write!(to, "a Klipper board{chip}, firmware {version}")?;
            }
        }
        match self.axes() {
            [] => Ok(()),
            [axis] => write!(to, ", axis {axis}"),
            axes => {
                let axes: Vec<_> = axes.iter().map(|axis| axis.as_str()).collect();
                write!(to, ", axes {}", axes.join(", "))
            }
        }
    }
}

/// Asks every port for a grbl board, for a node where there is none, and then for a board with the Klipper firmware,
/// all ports at once and for some seconds at most. Nothing moves, and no board is taken. Returns each port with its
/// board, or the reason why there is none.
///
/// The first open of a port since the computer started may reset its board, as an Arduino's.
///
/// # Errors
/// Each port has an error of its own: [`DriveError::Busy`] where another process holds it.
pub fn find_boards(ports: &[PathBuf], stop: &StopRequest) -> Vec<(PathBuf, Result<FoundBoard, DriveError>)> {
    thread::scope(|scope| {
        let asked = ports.iter().map(|port| (port, scope.spawn(|| find_any(port, stop))));
        let asked: Vec<_> = asked.collect();
        let answers = asked.into_iter().map(|(port, thread)| {
            let found = thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            (port.clone(), found)
        });
        answers.collect()
    })
}

/// Asks one port who is there, as [`find_boards`] does, but for the board of the driver `named` first: a node and a
/// Klipper board answer at once, and a grbl board may start for seconds. Whoever names a driver lets it ask the port.
///
/// # Errors
/// [`DriveError`] where no board answers that can be used, or another process holds the port.
pub fn find_board(
    port: &Path,
    named: Option<DriverName>,
    stop: &StopRequest,
) -> Result<FoundBoard, DriveError> {
    let (answer, is_none): (_, fn(&DriveError) -> bool) = match named {
        Some(DriverName::Node) => (ask_node(port, stop), is_no_node),
        Some(DriverName::Klipper) => (ask_klipper(port, stop), is_no_klipper),
        _ => return find_any(port, stop),
    };
    match answer {
        Err(error) if is_none(&error) => find_any(port, stop),
        answer => answer,
    }
}

/// Asks one port for a grbl board, and then for the others.
fn find_any(port: &Path, stop: &StopRequest) -> Result<FoundBoard, DriveError> {
    let grbl = match ask_board(port, stop) {
        Ok((state, axes)) => return Ok(FoundBoard::Grbl { state, axes }),
        Err(error @ DriveError::Device(_)) => error,
        Err(error) => return Err(error),
    };
    // A board that cannot be used is said, and anything else is none.
    ask_others(port, stop).map_err(
        |other| {
            if is_of_board(&other) { other } else { neither(port, grbl, &other) }
        },
    )
}

/// Returns the error of a board that is not there as its driver asks it, or that of the other kind of board that
/// answers at its port. Nothing moves.
pub(super) fn told_apart(error: DriveError, table: &DriveTable, stop: &StopRequest) -> DriveError {
    let DriveError::Device(source) = &error else { return error };
    let Some(port) = &table.port else { return error };
    let is_no_grbl = matches!(source.downcast_ref(), Some(GrblError::NoGrbl { .. }));
    let found = match table.driver {
        DriverName::Grbl if is_no_grbl => ask_others(port, stop),
        DriverName::Node if is_no_node(&error) => {
            ask_grbl(port, stop).or_else(|grbl| ask_klipper(port, stop).map_err(|_| grbl))
        }
        DriverName::Klipper if is_no_klipper(&error) => {
            ask_grbl(port, stop).or_else(|grbl| ask_node(port, stop).map_err(|_| grbl))
        }
        _ => return error,
    };
    match found {
        Ok(found) => DriveError::OtherDriver {
            port: port.clone(),
            found: found.to_string(),
            driver: found.driver().as_str(),
            named: table.driver.as_str(),
        },
        Err(found) if is_of_board(&found) => found,
        Err(_) => error,
    }
}

/// Returns the error of a port at which no board answers to any driver, or that of the grbl board that it has.
fn neither(port: &Path, grbl: DriveError, other: &DriveError) -> DriveError {
    let heard = match &grbl {
        DriveError::Device(error) => match error.downcast_ref() {
            Some(GrblError::NoGrbl { heard, .. }) => heard.clone(),
            _ => return grbl,
        },
        _ => return grbl,
    };
    if !is_no_node(other) {
        return grbl;
    }
    let baud = |driver| DriveTable::of(driver).rate_baud();
    let (node, grbl) = (baud(DriverName::Node), baud(DriverName::Grbl));
    let asked = if cfg!(feature = "klipper") {
        let klipper = baud(DriverName::Klipper);
        format!("a node ({node} baud), a grbl board ({grbl} baud) nor a Klipper board ({klipper} baud)")
    } else {
        format!("a node ({node} baud) nor a grbl board ({grbl} baud)")
    };
    DriveError::NoBoard { port: port.to_owned(), asked, heard }
}

/// Returns true for the error of a port at which no node answers.
fn is_no_node(error: &DriveError) -> bool {
    let DriveError::Device(error) = error else { return false };
    matches!(error.downcast_ref(), Some(NodeError::Silent { .. } | NodeError::Foreign { .. }))
}

/// Asks for a board whose driver has no setting that a byte of these questions could change: a node, then a board with
/// the Klipper firmware. A grbl board is asked before, because the Klipper firmware's sync byte lets it go on from a
/// hold.
fn ask_others(port: &Path, stop: &StopRequest) -> Result<FoundBoard, DriveError> {
    match ask_node(port, stop) {
        Err(node) if is_no_node(&node) => match ask_klipper(port, stop) {
            Ok(found) => Ok(found),
            Err(klipper) if is_of_board(&klipper) => Err(klipper),
            Err(_) => Err(node),
        },
        answer => answer,
    }
}

fn ask_grbl(port: &Path, stop: &StopRequest) -> Result<FoundBoard, DriveError> {
    let table = DriveTable::of(DriverName::Grbl).with_port(port);
    grbl::ask(&table, STARTED, stop).map(|(state, axes)| FoundBoard::Grbl { state, axes })
}

#[cfg(feature = "klipper")]
fn ask_klipper(port: &Path, stop: &StopRequest) -> Result<FoundBoard, DriveError> {
    let identity = klipper::ask(port, DriveTable::of(DriverName::Klipper).rate_baud(), stop)?;
    Ok(FoundBoard::Klipper { chip: identity.chip, version: identity.version, pins: identity.pins })
}

#[cfg(not(feature = "klipper"))]
fn ask_klipper(_port: &Path, _stop: &StopRequest) -> Result<FoundBoard, DriveError> {
    Err(DriveError::NotBuilt { driver: DriverName::Klipper.as_str() })
}

/// Returns true for the error of a port at which no board with the Klipper firmware answers.
#[cfg(feature = "klipper")]
fn is_no_klipper(error: &DriveError) -> bool {
    let DriveError::Device(error) = error else { return false };
    matches!(error.downcast_ref(), Some(KlipperError::Silent { .. } | KlipperError::Foreign { .. }))
}

#[cfg(not(feature = "klipper"))]
fn is_no_klipper(_error: &DriveError) -> bool {
    false
}

fn ask_node(port: &Path, stop: &StopRequest) -> Result<FoundBoard, DriveError> {
    let identity = node::ask(port, DriveTable::of(DriverName::Node).rate_baud(), stop)?;
    let (board, firmware, axes) = (identity.board, identity.firmware, identity.axes);
    Ok(FoundBoard::Node { board, firmware, axes })
}

/// Returns true for an error that only a node or a board with the Klipper firmware gives, or that ends the search.
fn is_of_board(error: &DriveError) -> bool {
    matches!(error, DriveError::Interrupted) || board_has_answered(error)
}

/// Returns true for the error of a board that has answered, and that this program cannot use: it has firmware of
/// another version, or none that its driver takes.
pub fn board_has_answered(error: &DriveError) -> bool {
    match error {
        DriveError::Device(error) | DriveError::Refused(error) => {
            matches!(error.downcast_ref::<NodeError>(), Some(NodeError::Version { .. }))
                || is_of_klipper(error.as_ref())
        }
        _ => false,
    }
}

#[cfg(feature = "klipper")]
fn is_of_klipper(error: &(dyn StdError + Send + Sync + 'static)) -> bool {
    use KlipperError::{Dictionary, Garbled, OtherFirmware};
    matches!(error.downcast_ref(), Some(Dictionary(_) | Garbled { .. } | OtherFirmware { .. }))
}

#[cfg(not(feature = "klipper"))]
fn is_of_klipper(_error: &(dyn StdError + Send + Sync + 'static)) -> bool {
    false
}
