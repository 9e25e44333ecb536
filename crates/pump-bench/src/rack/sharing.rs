//! Claims of two pumps of a rack on one thing: a record, an axis, or a board that starts all its axes as one.

use super::error::RackError;
use super::member::Member;
use crate::bench::Bench;
use crate::files::is_one_file;
use crate::pump_file::DriverName;

/// Refuses the first two pumps that share a record, an axis, or a board other than a node.
pub(super) fn check(members: &[Member]) -> Result<(), RackError> {
    for (number, member) in members.iter().enumerate() {
        for other in &members[..number] {
            if let Some((shared, instead)) = shared(&other.bench, &member.bench) {
                let (pump, other) = (other.name.clone(), member.name.clone());
                return Err(RackError::Shared { pump, other, shared, instead });
            }
        }
    }
    Ok(())
}

/// Returns the thing that two pumps share, and the way out.
fn shared(one: &Bench, other: &Bench) -> Option<(String, &'static str)> {
    if one.folder() == other.folder() {
        let shared = format!("are one pump, `{}`", one.file().pump.id);
        return Some((shared, "name each pump once, or give each file a [pump] id of its own"));
    }
    if !is_one_board(one, other) {
        return None;
    }
    let (port, axis) = (one.board_port()?.display(), one.drive().axis);
    let (driver, other_driver) = (one.drive().driver, other.drive().driver);
    if driver != other_driver {
        let shared = format!("are turned by {driver} and {other_driver} at one port, {port}");
        return Some((shared, "give each board its own port"));
    }
    if axis == other.drive().axis {
        return Some((
            format!("name one axis, {axis} at {port}"),
            "name the axis of each pump in its [drive]",
        ));
    }
    match driver {
        DriverName::Grbl => Some((
            format!("are axes of one grbl board, at {port}, which starts and stops all its axes as one"),
            "give each pump a board of its own, or the axes of a node (driver = \"node\")",
        )),
        DriverName::Node | DriverName::Sim => None,
    }
}

/// Returns true if boards at one port turn both pumps. No board turns a simulated pump.
pub(super) fn is_one_board(one: &Bench, other: &Bench) -> bool {
    let ports = one.board_port().zip(other.board_port());
    ports.is_some_and(|(port, at)| port == at || is_one_file(port, at))
}
