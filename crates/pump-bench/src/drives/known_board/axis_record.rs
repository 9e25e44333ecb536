//! The pumps on record of one board: an axis, or a socket of a board without axes, turns one of them.

use std::fs;
use std::path::{Path, PathBuf};

use super::known_board::{BoardError, KnownBoard, RECORD, read};
use crate::drives::opening::Opening;

/// Pump whose record names a board.
#[derive(Debug, Clone)]
pub(in crate::drives) struct RecordedPump {
    /// Name of the pump's folder, which is its id.
    pub(in crate::drives) pump: String,
    path: PathBuf,
    /// Board, with the axis or the pins that turn it.
    pub(in crate::drives) board: KnownBoard,
}

impl RecordedPump {
    /// Returns the record of the pump of this name under the same drive. `None` if it has none that can be read.
    #[cfg(any(feature = "klipper", all(feature = "grbl", feature = "node")))]
    pub(in crate::drives) fn named(pump: &str, opening: &Opening) -> Option<Self> {
        let drive = opening.settings_record.as_deref().and_then(Path::parent).and_then(Path::file_name)?;
        let all = opening.boards.as_deref().and_then(Path::parent)?;
        let path = all.join(pump).join(drive).join(RECORD);
        let board = read(&path).ok().flatten()?;
        Some(Self { pump: pump.to_owned(), path, board })
    }

    /// Returns the other pumps whose records name `board`. The pump's own record is in `PUMP/DRIVE` of the
    /// folder of all records, which has that of the boards too. A record that cannot be read is that of no pump.
    pub(in crate::drives) fn of_board(board: &KnownBoard, opening: &Opening) -> Vec<Self> {
        let drive = opening.settings_record.as_deref().and_then(Path::parent);
        let all = opening.boards.as_deref().and_then(Path::parent);
        let (Some(all), Some((pump, drive))) =
            (all, drive.and_then(|drive| drive.parent().zip(drive.file_name())))
        else {
            return Vec::new();
        };
        if pump.parent() != Some(all) {
            return Vec::new();
        }
        let folders = fs::read_dir(all);
        let folders = folders.into_iter().flatten().flatten();
        let others = folders.filter(|folder| Some(folder.file_name().as_os_str()) != pump.file_name());
        let found = others.filter_map(|folder| {
            let path = folder.path().join(drive).join(RECORD);
            let recorded = read(&path).ok().flatten().filter(|recorded| board.is_surely(recorded))?;
            let pump = folder.file_name().into_string().ok()?;
            Some(Self { pump, path, board: recorded })
        });
        let mut found: Vec<_> = found.collect();
        found.sort_by(|one, other| one.pump.cmp(&other.pump));
        found
    }

    /// Forgets the axis and the pins of this pump that those of another one are, which is in its place.
    pub(in crate::drives) fn displace(&self, by: &KnownBoard) -> Result<(), BoardError> {
        let axis = self.board.axis.filter(|axis| Some(*axis) != by.axis);
        let mut pins = self.board.pins.clone();
        pins.retain(|pin| !by.pins.contains(pin));
        KnownBoard { axis, pins, ..self.board.clone() }.write(&self.path)
    }
}
