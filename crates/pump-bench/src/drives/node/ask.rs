//! The question to a serial port: is a node there? Nothing moves, and no board is taken.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use pump_link::message::Identity;

use super::connect;
use super::error::NodeOpening;
use super::link::Link;
use super::shared_line::SharedLine;
use crate::drives::wire::BoardPort;
use crate::drives::{DriveError, StopRequest};
use crate::pump_file::Axis;

/// Longest wait for an answer. A board answers within milliseconds, and a port that was just opened may lose some
/// bytes.
const LIMIT: Duration = Duration::from_secs(1);

/// Asks the port for a node at `baud`, for a second at most. Returns who it is.
pub(in crate::drives) fn ask(port: &Path, baud: u32, stop: &StopRequest) -> Result<Identity, DriveError> {
    let wire = BoardPort::open(Some(port), baud).map_err(|error| NodeOpening::from(error).0)?;
    let line = Arc::new(SharedLine::new(Box::new(wire)));
    let mut link = Link::new(line, Axis::X, stop.clone())?;
    let (identity, _session) = connect::identify(&mut link, port, baud, LIMIT)?;
    Ok(identity)
}
