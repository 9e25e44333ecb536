//! The sizes of the firmware: its flash, and its memory with the deepest stack that was seen.

use std::error::Error;
use std::path::Path;

use crate::check;

/// Bytes of a kB, as in the 264 kB of memory that the chip has (RP2040 datasheet, section 2.6.2).
const KB: u32 = 1_024;

/// Most flash and most memory of the firmware, its stack included, in bytes.
const MOST_FLASH: u32 = 48 * KB;
const MOST_MEMORY: u32 = 96 * KB;

/// Start of the memory, and its end, where the stack begins (RP2040 datasheet, section 2.2).
const MEMORY: u32 = 0x2000_0000;
pub(crate) const STACK: u32 = 0x2004_0000;

/// Type of a loadable segment in an ELF file (ELF-32, figure 2-2).
const LOADED: u32 = 1;

/// Prints the sizes of the firmware and holds them below their limits.
pub(crate) fn hold(firmware: &Path, stack: u32) -> Result<(), Box<dyn Error>> {
    let elf = std::fs::read(firmware)?;
    let (mut flash, mut memory) = (0, 0);
    for segment in segments(&elf).ok_or("the firmware is no ELF file of 32 bits")? {
        flash += segment.in_file;
        if segment.address >= MEMORY {
            memory += segment.in_memory;
        }
    }
    println!("{flash} bytes of flash; {memory} bytes of memory, and {stack} of stack");
    check(flash > 0 && flash < MOST_FLASH, "the size of the flash")?;
    check(memory > 0 && stack > 0 && memory + stack < MOST_MEMORY, "the size of the memory with its stack")
}

/// Segment that is loaded.
pub(crate) struct Segment {
    /// Place of its bytes in the ELF file.
    pub(crate) place: u32,
    /// Address at which it is used.
    address: u32,
    /// Address at which the flash holds it.
    pub(crate) stored: u32,
    /// Bytes that the flash holds.
    pub(crate) in_file: u32,
    /// Bytes at that address.
    in_memory: u32,
}

/// Returns the segments of an ELF file that are loaded (ELF-32, figures 1-3 and 2-1).
pub(crate) fn segments(elf: &[u8]) -> Option<Vec<Segment>> {
    elf.starts_with(b"\x7fELF\x01").then_some(())?;
    let short = |at: usize| Some(u16::from_le_bytes(*elf.get(at..)?.first_chunk()?));
    let word = |at: usize| Some(u32::from_le_bytes(*elf.get(at..)?.first_chunk()?));
    let (first, size, number) = (word(28)? as usize, usize::from(short(42)?), usize::from(short(44)?));
    let mut segments = Vec::new();
    for at in (0..number).map(|number| first + number * size) {
        if word(at)? == LOADED {
            let (place, address, stored) = (word(at + 4)?, word(at + 8)?, word(at + 12)?);
            let (in_file, in_memory) = (word(at + 16)?, word(at + 20)?);
            segments.push(Segment { place, address, stored, in_file, in_memory });
        }
    }
    Some(segments)
}
