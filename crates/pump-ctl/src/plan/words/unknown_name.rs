//! The refusal of a name that is not among those of a choice.

use core::fmt;

/// Number of bytes of a refused name that the error repeats at most.
const KEPT_BYTES: usize = 40;

/// The refusal of a name that is not among those of a choice.
///
/// The error repeats the first 40 bytes of the name, so it needs no allocator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct UnknownName {
    /// Name of the choice, as users know it.
    choice: &'static str,
    name: [u8; KEPT_BYTES],
    length: usize,
    /// True if the name is longer than the bytes kept of it.
    cut: bool,
    allowed: &'static [&'static str],
}

impl UnknownName {
    /// Refuses `name` for `choice`, which has the names `allowed`.
    pub(super) fn new(choice: &'static str, name: &str, allowed: &'static [&'static str]) -> Self {
        let ends = name.char_indices().map(|(at, letter)| at + letter.len_utf8());
        let length = ends.take_while(|end| *end <= KEPT_BYTES).last().unwrap_or(0);
        let mut kept = [0; KEPT_BYTES];
        for (slot, byte) in kept.iter_mut().zip(name.bytes().take(length)) {
            *slot = byte;
        }
        Self { choice, name: kept, length, cut: length < name.len(), allowed }
    }

    /// Returns the names that the choice has.
    pub fn allowed(&self) -> &'static [&'static str] {
        self.allowed
    }

    /// Returns the refused name, as far as it is kept.
    fn name(&self) -> &str {
        self.name.get(..self.length).and_then(|bytes| core::str::from_utf8(bytes).ok()).unwrap_or_default()
    }
}

impl fmt::Display for UnknownName {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let more = if self.cut { "..." } else { "" };
        write!(to, "{} is '{}{more}'; allowed: ", self.choice, self.name())?;
        for (n, name) in self.allowed.iter().enumerate() {
            let comma = if n == 0 { "" } else { ", " };
            write!(to, "{comma}'{name}'")?;
        }
        Ok(())
    }
}

impl core::error::Error for UnknownName {}
