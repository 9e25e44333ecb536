//! The kinds of a message's values.

use std::ops::RangeInclusive;

/// Kind of a value, by its place holder in a format string.
///
/// Source: Klipper3d/klipper, `docs/MCU_Commands.md` for the place holders in use. By `docs/Protocol.md` the size of a
/// number does not change its bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drives::klipper) enum Kind {
    /// `%u`
    U32,
    /// `%i`
    I32,
    /// `%hu`
    U16,
    /// `%hi`
    I16,
    /// `%c`
    U8,
    /// `%s`, `%*s` or `%.*s`
    Bytes,
}

/// Place holders, and their kinds.
const PLACE_HOLDERS: [(&str, Kind); 8] = [
    ("%u", Kind::U32),
    ("%i", Kind::I32),
    ("%hu", Kind::U16),
    ("%hi", Kind::I16),
    ("%c", Kind::U8),
    ("%s", Kind::Bytes),
    ("%*s", Kind::Bytes),
    ("%.*s", Kind::Bytes),
];

impl Kind {
    /// Returns the kind of a place holder. `None` if no value has it.
    pub(super) fn of(place_holder: &str) -> Option<Self> {
        PLACE_HOLDERS.iter().find(|(text, _)| *text == place_holder).map(|(_, kind)| *kind)
    }

    /// Splits the place holder from the front of `text`. `None` if no place holder is there.
    pub(super) fn split(text: &str) -> Option<(Self, &str)> {
        PLACE_HOLDERS.iter().find_map(|(start, kind)| Some((*kind, text.strip_prefix(start)?)))
    }

    /// Returns the numbers of this kind. `None` for bytes.
    pub(super) fn range(self) -> Option<RangeInclusive<i64>> {
        Some(match self {
            Self::U32 => 0..=i64::from(u32::MAX),
            Self::I32 => i64::from(i32::MIN)..=i64::from(i32::MAX),
            Self::U16 => 0..=i64::from(u16::MAX),
            Self::I16 => i64::from(i16::MIN)..=i64::from(i16::MAX),
            Self::U8 => 0..=i64::from(u8::MAX),
            Self::Bytes => return None,
        })
    }

    /// Returns the number of these bits.
    pub(super) fn number(self, bits: u32) -> i64 {
        match self {
            Self::I32 | Self::I16 => i64::from(bits.cast_signed()),
            Self::U32 | Self::U16 | Self::U8 | Self::Bytes => i64::from(bits),
        }
    }
}
