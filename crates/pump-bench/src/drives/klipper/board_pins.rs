//! The pins of a board that was found at a port, as its dictionary tells them.

use super::dictionary::Dictionary;
use super::error::KlipperError;
use crate::drives::DriveError;
use crate::pump_file::KlipperTable;

/// Pins of a board with the Klipper firmware.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardPins(Dictionary);

// Each part of a dictionary is equal to itself.
impl Eq for BoardPins {}

impl BoardPins {
    /// Returns the pins that a dictionary tells.
    pub(super) fn new(dictionary: Dictionary) -> Self {
        Self(dictionary)
    }

    /// Refuses the first pin of a table that the board lacks, or uses itself.
    pub(in crate::drives) fn check(&self, table: &KlipperTable) -> Result<(), DriveError> {
        let tmc = table.tmc.as_ref();
        let others = [
            table.enable.as_ref(),
            table.index.as_ref(),
            tmc.map(|tmc| &tmc.uart),
            tmc.and_then(|tmc| tmc.tx.as_ref()),
        ];
        for pin in [&table.step, &table.dir].into_iter().chain(others.into_iter().flatten()) {
            self.0.pin(&pin.name).map_err(KlipperError::from)?;
        }
        Ok(())
    }
}
