//! The pieces in which a dictionary comes.

use super::dictionary::Dictionary;
use super::error::DictionaryError;

/// Bytes of a piece that is asked for. A block has room for them whatever their place.
///
/// Source: Klipper3d/klipper, whose host asks for as many (`klippy/serialhdl.py`).
pub(super) const PIECE: u8 = 40;

/// Most bytes of a compressed dictionary. Boards with every option of the firmware have some 10,000.
const MOST: usize = 1 << 16;

/// Dictionary under way.
#[derive(Debug, Default)]
pub(in crate::drives::klipper) struct Download {
    bytes: Vec<u8>,
}

impl Download {
    /// Returns the place of the next piece, and the bytes to ask for.
    pub(in crate::drives::klipper) fn wanted(&self) -> (u32, u8) {
        (u32::try_from(self.bytes.len()).unwrap_or(u32::MAX), PIECE)
    }

    /// Takes a piece. Returns the dictionary after the last one, which is empty. A piece for another place is an
    /// answer that came late or twice, and nothing is done with it.
    pub(in crate::drives::klipper) fn take(
        &mut self,
        place: u32,
        piece: &[u8],
    ) -> Result<Option<Dictionary>, DictionaryError> {
        if place != self.wanted().0 {
            return Ok(None);
        }
        if piece.is_empty() {
            return Dictionary::of_compressed(&self.bytes).map(Some);
        }
        self.bytes.extend_from_slice(piece);
        if self.bytes.len() > MOST {
            return Err(DictionaryError::Large { form: "compressed", most: MOST });
        }
        Ok(None)
    }
}
