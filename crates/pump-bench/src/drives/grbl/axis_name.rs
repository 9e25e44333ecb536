//! The number and the letter of an axis, as the protocol names it.

use crate::pump_file::Axis;

/// Letters of the axes, in the order of a report's coordinates.
const LETTERS: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

/// Returns the letter of the axis at this place of a report, from 0.
pub(super) fn letter_at(place: usize) -> char {
    LETTERS.get(place).copied().unwrap_or('?')
}

/// Returns the axes of a board that reports so many, in words.
pub(super) fn axes_in_words(axes: usize) -> String {
    let letters: Vec<String> = LETTERS.iter().take(axes).map(char::to_string).collect();
    match letters.split_last() {
        Some((only, [])) => format!("the axis {only} alone"),
        Some((last, others)) => format!("the axes {} and {last}", others.join(", ")),
        None => "no axis".to_owned(),
    }
}

impl Axis {
    /// Returns the axis's place among the axes, 0 for X.
    pub(super) fn number(self) -> usize {
        self as usize
    }

    /// Returns the axis's letter.
    pub(super) fn letter(self) -> char {
        letter_at(self.number())
    }
}
