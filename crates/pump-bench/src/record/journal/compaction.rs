//! The announcements of a long motion, of which the journal keeps the last ones.
//!
//! Each announcement makes the ones before it void, so a run of a day need not leave all of them. The first one of a
//! long motion stands in a slot: a line of fixed length within one sector of the disk. Once enough others stand behind
//! it, the last announcement takes the slot, and what stands behind is cut off. A process or a computer that ends
//! between the two leaves all lines, of which the last one counts as ever.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};

use super::journal::Storage;
use super::{Entry, line};

/// Time of a motion from which on its announcements are compacted, in s.
const LONG_S: f64 = 600.0;

/// Length of the announcements behind the slot from which on they are compacted, in bytes. At four a second they take
/// 13 minutes.
const MOST: u64 = 1 << 18;

/// Length of the slot, its newline included, in bytes. The longest announcement has some 110.
const SLOT: u64 = 160;

/// Length of a sector, in bytes: a disk writes it whole or not at all.
const SECTOR: u64 = 512;

/// Announcements of a motion.
#[derive(Debug, Clone, Copy, Default)]
pub(super) enum Compaction {
    /// The motion is short, or none is under way.
    #[default]
    Off,
    /// A long motion has no announcement yet.
    Waits,
    /// The slot is at this place, and its line has this number.
    Slot { at: u64, number: u64 },
}

impl Compaction {
    /// Returns the state after `entry` was written as a line of this number, whose text begins at `at`.
    pub(super) fn after(self, entry: &Entry, number: u64, text: &str, at: u64) -> Self {
        match (entry, self) {
            (Entry::Intent(intent), _) if intent.motion_s >= LONG_S => Self::Waits,
            (Entry::Progress { .. }, Self::Waits) if text.ends_with(" \n") => {
                let lead = text.len() - text.trim_start().len();
                Self::Slot { at: at + lead as u64, number }
            }
            (Entry::Progress { .. }, slot @ Self::Slot { .. }) => slot,
            _ => Self::Off,
        }
    }

    /// Returns the line of `entry` at place `at` of the file: the first announcement of a long motion is made a slot.
    pub(super) fn laid_out(self, entry: &Entry, text: String, at: u64) -> String {
        let is_first = matches!((self, entry), (Self::Waits, Entry::Progress { .. }));
        match slot_of(&text).filter(|_| is_first) {
            Some(slot) => {
                let within = at % SECTOR;
                let lead = if within + SLOT <= SECTOR { 0 } else { SECTOR - within };
                " ".repeat(lead as usize) + &slot
            }
            None => text,
        }
    }

    /// Puts `last`, the last announcement of `file`, into the slot and cuts off what stands behind it, if that is long.
    /// Returns the number of the next line and the length of the file then.
    ///
    /// # Errors
    ///
    /// The [`io::Error`] of the file or its storage.
    pub(super) fn compact(
        self,
        file: &mut File,
        storage: &mut dyn Storage,
        last: &Entry,
        length: u64,
    ) -> io::Result<Option<(u64, u64)>> {
        let Self::Slot { at, number } = self else { return Ok(None) };
        let ends = at + SLOT;
        if length.saturating_sub(ends) < MOST {
            return Ok(None);
        }
        let Some(slot) = slot_of(&line::encode_numbered(number, last)?) else { return Ok(None) };
        file.seek(SeekFrom::Start(at))?;
        file.write_all(slot.as_bytes())?;
        storage.sync(file)?;
        file.set_len(ends)?;
        // A line that is appended now must not be on the disk before the cut is.
        storage.sync(file)?;
        Ok(Some((number + 1, ends)))
    }
}

/// Returns the line of an announcement with spaces up to the length of a slot. `None` if it is too long.
fn slot_of(text: &str) -> Option<String> {
    let text = text.trim_end();
    let spaces = (SLOT as usize).checked_sub(text.len() + 1).filter(|spaces| *spaces > 0)?;
    Some(format!("{text}{}\n", " ".repeat(spaces)))
}
