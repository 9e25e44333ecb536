//! A short text of a record: a volume as it was typed, a name, or the reason of a stand.

use std::fmt;
use std::str;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Mark at the end of a text that was cut.
const CUT: &str = "…";

/// Short text of a record, as a volume that was typed: `25 mL`. A text of more than 40 bytes is cut, and ends with `…`.
pub type ShortText = CutText<40>;

/// Text of a record in a room of fixed size. A text of more than `MOST` bytes is cut, and ends with `…`. `MOST` is
/// 255 at most.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct CutText<const MOST: usize> {
    bytes: [u8; MOST],
    length: u8,
}

impl<const MOST: usize> CutText<MOST> {
    /// The room and the mark fit the counted length.
    const FITS: () = assert!(MOST >= CUT.len() && MOST <= u8::MAX as usize, "3 to 255 bytes are kept");

    /// Keeps a text.
    pub fn new(text: &str) -> Self {
        let () = Self::FITS;
        let mut kept = Self { bytes: [0; MOST], length: 0 };
        if text.len() <= MOST {
            kept.push(text);
            return kept;
        }
        let fits = |end: &usize| *end <= MOST - CUT.len() && text.is_char_boundary(*end);
        let end = (0..text.len()).rev().find(fits).unwrap_or(0);
        kept.push(&text[..end]);
        kept.push(CUT);
        kept
    }

    /// Returns the text.
    pub fn as_str(&self) -> &str {
        str::from_utf8(&self.bytes[..usize::from(self.length)]).unwrap_or_default()
    }

    /// Appends a text that fits.
    fn push(&mut self, text: &str) {
        let start = usize::from(self.length);
        let end = start + text.len();
        self.bytes[start..end].copy_from_slice(text.as_bytes());
        self.length = end as u8;
    }
}

impl<const MOST: usize> fmt::Debug for CutText<MOST> {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), to)
    }
}

impl<const MOST: usize> Serialize for CutText<MOST> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.as_str())
    }
}

impl<'de, const MOST: usize> Deserialize<'de> for CutText<MOST> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Ok(Self::new(&String::deserialize(from)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_comes_back_and_a_long_one_is_cut_between_letters() {
        for text in ["", "25 mL", "1e3 µL", &"x".repeat(40)] {
            assert_eq!(ShortText::new(text).as_str(), text);
        }
        assert_eq!(ShortText::new(&"x".repeat(41)).as_str(), "x".repeat(37) + "…");
        // Each µ has two bytes, and 37 bytes end within one.
        let cut = ShortText::new(&"µ".repeat(30));
        assert_eq!(cut.as_str(), "µ".repeat(18) + "…");
        assert_eq!(serde_json::from_str::<ShortText>(&serde_json::to_string(&cut).unwrap()).unwrap(), cut);
    }
}
