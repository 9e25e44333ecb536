//! The question to a serial port: is a grbl board there? Nothing moves, and no setting is read or written.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use super::board::Board;
use super::connect;
use crate::drives::wire::BoardPort;
use crate::drives::{DriveError, StopRequest};
use crate::pump_file::{DriveTable, DriverName};

/// Board that answers at a port: its state, as `Idle`, and the number of axes that it reports, 0 for none.
pub(in crate::drives) type Answering = (String, u8);

/// Asks the port of `table` for a grbl board, for as long as `limit`.
pub(in crate::drives) fn ask(
    table: &DriveTable,
    limit: Duration,
    stop: &StopRequest,
) -> Result<Answering, DriveError> {
    let wire = BoardPort::open(table.port.as_deref(), table.rate_baud())?;
    let mut board = Board::new(Box::new(wire), table.axis.number(), stop.clone());
    connect::find(&mut board, table, limit)?;
    let state = board.state(|| ())?.word();
    Ok((state, u8::try_from(board.axes()).unwrap_or(u8::MAX)))
}

/// Asks every port for a grbl board, all at once and for some seconds at most. Nothing moves. Returns each port with
/// the state of its board, as `Idle`, or the reason why there is none.
///
/// The first open of a port since the computer started may reset its board, as an Arduino's.
///
/// # Errors
/// Each port has an error of its own: [`DriveError::Busy`] where another process holds it.
pub fn ask_ports(ports: &[PathBuf], stop: &StopRequest) -> Vec<(PathBuf, Result<String, DriveError>)> {
    thread::scope(|scope| {
        let asked = ports.iter().map(|port| (port, scope.spawn(|| ask_board(port, stop))));
        let asked: Vec<_> = asked.collect();
        let answers = asked.into_iter().map(|(port, thread)| {
            let answer = thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            (port.clone(), answer.map(|(state, _)| state))
        });
        answers.collect()
    })
}

/// Asks a port for a grbl board, for as long as one takes to start.
pub(in crate::drives) fn ask_board(port: &Path, stop: &StopRequest) -> Result<Answering, DriveError> {
    ask(&DriveTable::of(DriverName::Grbl).with_port(port), connect::ANSWER_LIMIT, stop)
}
