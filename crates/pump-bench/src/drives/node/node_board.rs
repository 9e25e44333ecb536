//! A board that several drives of this process share, each for one axis.

use std::path::Path;
use std::sync::Arc;

use super::error::{NodeError, NodeOpening};
use super::link::Link;
use super::node::Node;
use super::shared_line::SharedLine;
use crate::drives::wire::{BoardPort, NotShared, OpenPorts, Wire};
use crate::drives::{DriveError, Opening};
use crate::pump_file::{DriveTable, MotorTable};

/// Ports of nodes that this process has open.
static OPEN: OpenPorts<SharedLine> = OpenPorts::new();

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
        let opened = || {
            let wire = BoardPort::open(port, baud).map_err(|error| NodeOpening::from(error).0)?;
            Ok(SharedLine::new(Box::new(wire)))
        };
        match OPEN.share(port, baud, |line| line.lock().is_broken(), opened) {
            Ok(line) => Ok(Self(line)),
            Err(NotShared::Rate { device, open_baud }) => {
                Err(NodeError::Rate { port: device, baud, open_baud }.into())
            }
            Err(NotShared::Open(error)) => Err(error),
        }
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
