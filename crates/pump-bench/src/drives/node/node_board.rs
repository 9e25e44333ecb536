//! A board that several drives of this process share, each for one axis.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};

use super::error::{NodeError, NodeOpening};
use super::link::Link;
use super::node::Node;
use super::shared_line::SharedLine;
use crate::drives::wire::{BoardPort, Wire};
use crate::drives::{DriveError, Opening};
use crate::pump_file::{DriveTable, MotorTable};

/// Ports that this process has open. No other process can open them, so the drives of this one share them.
static OPEN: Mutex<Vec<OpenPort>> = Mutex::new(Vec::new());

/// Port that is open as long as a drive uses its line.
#[derive(Debug)]
struct OpenPort {
    device: PathBuf,
    baud: u32,
    line: Weak<SharedLine>,
}

/// Board that several drives share, each for one axis and from a thread of its own.
#[doc(hidden)]
#[derive(Debug, Clone)]
pub struct NodeBoard(Arc<SharedLine>);

impl NodeBoard {
    /// Takes the board at the other end of `wire`.
    pub fn over(wire: Box<dyn Wire>) -> Self {
        Self(Arc::new(SharedLine::new(wire)))
    }

    /// Opens the port of a board, or shares it with the drives of this process that have it open.
    pub(super) fn open(port: Option<&Path>, baud: u32) -> Result<Self, DriveError> {
        let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
        open.retain(|port| port.line.strong_count() > 0);
        let device = port.map(|port| port.canonicalize().unwrap_or_else(|_| port.to_owned()));
        let device = device.unwrap_or_default();
        for there in open.iter().filter(|there| there.device == device) {
            let Some(line) = there.line.upgrade().filter(|line| !line.lock().is_broken()) else { continue };
            if there.baud != baud {
                return Err(NodeError::Rate { port: device, baud, open_baud: there.baud }.into());
            }
            return Ok(Self(line));
        }
        let wire = BoardPort::open(port, baud).map_err(|error| NodeOpening::from(error).0)?;
        let board = Self::over(Box::new(wire));
        open.push(OpenPort { device, baud, line: Arc::downgrade(&board.0) });
        Ok(board)
    }

    /// Meets the board, and configures the axis that `table` names. Moves nothing.
    ///
    /// # Errors
    ///
    /// [`DriveError`] as [`Node::open`], and for an axis that another drive has.
    pub fn axis(
        &self,
        table: &DriveTable,
        motor: &MotorTable,
        opening: &Opening,
    ) -> Result<Node, DriveError> {
        let link = Link::new(Arc::clone(&self.0), table.axis, opening.stop.clone())?;
        Node::linked(link, table, motor, opening)
    }
}
