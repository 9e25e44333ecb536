//! The board that the record of a pump names, for who shows it.

use super::known_board::{read, record_path};
use crate::drives::opening::Opening;
use crate::pump_file::Axis;

/// Board that the record of a pump names.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct BoardOnRecord {
    /// Number that no other board has. `None` if the board tells none.
    pub number: Option<u64>,
    /// Name that the board's port keeps. `None` if it keeps none.
    pub port_name: Option<String>,
    /// Axis that turns the pump. `None` for a board without axes, and after another pump has taken the place.
    pub axis: Option<Axis>,
}

impl BoardOnRecord {
    /// Reads the board of the pump of these terms. `None` without one on record, and if it cannot be read, which the
    /// next motion tells.
    pub fn of(opening: &Opening) -> Option<Self> {
        let board = read(&record_path(opening)?).ok().flatten()?;
        Some(Self { number: board.number, port_name: board.port_name, axis: board.axis })
    }
}
