//! The number and the letter of an axis, as the protocol names it.

use crate::pump_file::Axis;

impl Axis {
    /// Returns the axis's place among the axes, 0 for X.
    pub(super) fn number(self) -> usize {
        self as usize
    }

    /// Returns the axis's letter.
    pub(super) fn letter(self) -> char {
        match self {
            Self::X => 'X',
            Self::Y => 'Y',
            Self::Z => 'Z',
            Self::A => 'A',
            Self::B => 'B',
            Self::C => 'C',
        }
    }
}
