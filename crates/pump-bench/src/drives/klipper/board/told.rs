//! The disturbances that the records of a board and of its pumps tell before the board is met.

use super::board_record::BoardRecord;
use super::session_record::SessionRecord;
use crate::drives::{Disturbance, Opening};
use crate::pump_file::DriveTable;

/// Returns what has befallen a motor since it was met last, as far as this bench has done it for another pump of the
/// board. A record that cannot be read tells nothing: the next motion refuses it.
pub(in crate::drives) fn told_by_record(table: &DriveTable, opening: &Opening) -> Option<Disturbance> {
    let own = SessionRecord::read(opening.settings_record.as_deref()?).ok().flatten()?;
    let path = BoardRecord::path(opening, table.port.as_deref()?)?;
    let board = BoardRecord::read(&path).ok().flatten()?;
    match own.session == board.session {
        true => (own.has_current && own.cuts != board.cuts).then_some(Disturbance::Disabled),
        false if board.before.contains(&own.session) => Some(Disturbance::Reconfigured),
        false => Some(Disturbance::Reset),
    }
}
