//! The size of a tube: its two diameters.

use super::error::QuantityError;
use super::kind::Kind;
use super::quantity::length_mm;
use super::reading::{QuantityText, shown};

/// The two diameters of a tube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TubeSize {
    /// Inner diameter, in mm.
    pub bore_mm: f64,
    /// Outer diameter, in mm.
    pub outer_mm: f64,
}

/// Reads a tube as bore x outer diameter, both positive: `10x14mm`, `3.2 x 6.4 mm`.
///
/// # Errors
/// [`QuantityError::NoTube`] if the text has no `x`. [`QuantityError::NoWall`] if the tube has no
/// wall. Otherwise the error of a diameter that is no positive length.
pub fn tube_size(text: &str) -> Result<TubeSize, QuantityError> {
    let no_tube = || QuantityError::NoTube { text: shown(text.trim()) };
    let (bore, outer) = text.split_once(['x', 'X', '×']).ok_or_else(no_tube)?;
    let outer_mm = length_mm(outer)?;
    let bore = bore.trim();
    // A bore without a unit has the unit of the outer diameter.
    let unit = QuantityText::new(outer, Kind::Length)?.unit;
    let bore_mm = match bore.ends_with(|c: char| c.is_ascii_digit() || c == '.') {
        true => length_mm(&format!("{bore}{unit}"))?,
        false => length_mm(bore)?,
    };
    if outer_mm <= bore_mm {
        return Err(QuantityError::NoWall { text: shown(text.trim()), bore_mm, outer_mm });
    }
    Ok(TubeSize { bore_mm, outer_mm })
}
