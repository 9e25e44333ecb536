//! Boards that are found by asking the ports: grbl boards and nodes.

use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use super::error::DriveError;
use super::grbl::{self, GrblError, ask_boards};
use super::known_board::{KnownBoard, RecordedPump};
use super::opening::Opening;
use super::stop_request::StopRequest;
use super::{NodeError, node};
use crate::pump_file::{Axis, DriveTable, DriverName};

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
}

impl FoundBoard {
    /// Returns the axes of the board. Empty for a board that does not tell.
    pub fn axes(&self) -> &'static [Axis] {
        let (Self::Grbl { axes, .. } | Self::Node { axes, .. }) = self;
        Axis::ALL.get(..usize::from(*axes)).unwrap_or(Axis::ALL)
    }

    /// Returns the number of the board, if it tells one.
    pub fn number(&self) -> Option<u64> {
        match self {
            Self::Node { board, .. } => Some(*board).filter(|board| *board != 0),
            Self::Grbl { .. } => None,
        }
    }

    /// Returns the other pumps on record that axes of this board turn, each with its axis. `opening` is that of a
    /// bench. A grbl board is known by the name that its port keeps.
    pub fn pumps_on_record(&self, port: &Path, opening: &Opening) -> Vec<(String, Axis)> {
        let found = self.marks(port, None, opening);
        let pumps = RecordedPump::of_board(&found, opening);
        pumps.into_iter().map(|pump| (pump.pump, pump.axis)).collect()
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

    fn marks(&self, port: &Path, axis: Option<Axis>, opening: &Opening) -> KnownBoard {
        KnownBoard { number: self.number(), axis, ..KnownBoard::at_port(Some(port), opening) }
    }

    /// Returns the name of the board's driver.
    pub fn driver(&self) -> DriverName {
        match self {
            Self::Grbl { .. } => DriverName::Grbl,
            Self::Node { .. } => DriverName::Node,
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

/// Asks every port for a grbl board, and for a node where there is none, all ports at once and for some seconds at
/// most. Nothing moves, and no board is taken. Returns each port with its board, or the reason why there is none.
///
/// The first open of a port since the computer started may reset its board, as an Arduino's.
///
/// # Errors
/// Each port has an error of its own: [`DriveError::Busy`] where another process holds it.
pub fn find_boards(ports: &[PathBuf], stop: &StopRequest) -> Vec<(PathBuf, Result<FoundBoard, DriveError>)> {
    let asked = ask_boards(ports, stop);
    thread::scope(|scope| {
        let asked = asked.into_iter().map(|(port, answer)| {
            let asks_node = matches!(answer, Err(DriveError::Device(_)));
            let at = port.clone();
            (port, answer, asks_node.then(|| scope.spawn(move || ask_node(&at, stop))))
        });
        let asked: Vec<_> = asked.collect();
        let answers = asked.into_iter().map(|(port, answer, node)| {
            let node =
                node.map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
            let found = match (answer, node) {
                (Ok((state, axes)), _) => Ok(FoundBoard::Grbl { state, axes }),
                (Err(_), Some(Ok(found))) => Ok(found),
                // A node that cannot be used is said, and anything else is no node.
                (Err(_), Some(Err(error))) if is_of_node(&error) => Err(error),
                (Err(grbl), Some(Err(node))) => Err(neither(&port, grbl, &node)),
                (Err(error), None) => Err(error),
            };
            (port, found)
        });
        answers.collect()
    })
}

/// Returns the error of a board that is not there as its driver asks it, or that of the other kind of board that
/// answers at its port. Nothing moves.
pub(super) fn told_apart(error: DriveError, table: &DriveTable, stop: &StopRequest) -> DriveError {
    let DriveError::Device(source) = &error else { return error };
    let Some(port) = &table.port else { return error };
    let is_no_grbl = matches!(source.downcast_ref(), Some(GrblError::NoGrbl { .. }));
    let found = match table.driver {
        DriverName::Grbl if is_no_grbl => ask_node(port, stop),
        DriverName::Node if is_no_node(&error) => {
            let table = DriveTable::of(DriverName::Grbl).with_port(port);
            grbl::ask(&table, STARTED, stop).map(|(state, axes)| FoundBoard::Grbl { state, axes })
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
        Err(found) if is_of_node(&found) => found,
        Err(_) => error,
    }
}

/// Returns the error of a port at which no board answers to either driver, or that of the grbl board that it has.
fn neither(port: &Path, grbl: DriveError, node: &DriveError) -> DriveError {
    let heard = match &grbl {
        DriveError::Device(error) => match error.downcast_ref() {
            Some(GrblError::NoGrbl { heard, .. }) => heard.clone(),
            _ => return grbl,
        },
        _ => return grbl,
    };
    if !is_no_node(node) {
        return grbl;
    }
    let [node_baud, grbl_baud] =
        [DriverName::Node, DriverName::Grbl].map(|driver| DriveTable::of(driver).rate_baud());
    DriveError::NoBoard { port: port.to_owned(), node_baud, grbl_baud, heard }
}

/// Returns true for the error of a port at which no node answers.
fn is_no_node(error: &DriveError) -> bool {
    let DriveError::Device(error) = error else { return false };
    matches!(error.downcast_ref(), Some(NodeError::Silent { .. } | NodeError::Foreign { .. }))
}

fn ask_node(port: &Path, stop: &StopRequest) -> Result<FoundBoard, DriveError> {
    let identity = node::ask(port, DriveTable::of(DriverName::Node).rate_baud(), stop)?;
    let (board, firmware, axes) = (identity.board, identity.firmware, identity.axes);
    Ok(FoundBoard::Node { board, firmware, axes })
}

/// Returns true for an error that only a node gives, or that ends the search.
fn is_of_node(error: &DriveError) -> bool {
    match error {
        DriveError::Interrupted => true,
        DriveError::Device(error) => {
            matches!(error.downcast_ref::<NodeError>(), Some(NodeError::Version { .. }))
        }
        _ => false,
    }
}
