//! The size of a hose: its tube and its length.

use super::error::QuantityError;
use super::quantity::length_mm;
use super::reading::shown;
use super::tube_size::{TubeSize, tube_size};

/// The diameters and the length of a hose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoseSize {
    /// Diameters of the hose.
    pub tube: TubeSize,
    /// Length of the hose, in mm.
    pub length_mm: f64,
}

/// Reads a hose as bore x outer diameter, a comma, and the length: `6x10mm,1m`, `3.2 x 6.4 mm, 80 cm`.
///
/// ```
/// let hose = pump_bench::units::hose_size("6x10mm,1m")?;
/// assert_eq!((hose.tube.bore_mm, hose.tube.outer_mm, hose.length_mm), (6.0, 10.0, 1000.0));
/// # Ok::<(), pump_bench::units::QuantityError>(())
/// ```
///
/// # Errors
/// [`QuantityError::NoHose`] if the text has no comma. Otherwise the error of a tube or a length that is none.
pub fn hose_size(text: &str) -> Result<HoseSize, QuantityError> {
    let (tube, length) =
        text.split_once(',').ok_or_else(|| QuantityError::NoHose { text: shown(text.trim()) })?;
    Ok(HoseSize { tube: tube_size(tube)?, length_mm: length_mm(length)? })
}
