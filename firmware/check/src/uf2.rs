//! The file that is dragged onto a Pico: it holds the firmware, and nothing else.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use crate::check;
use crate::size::segments;

/// Bytes of a block, and most bytes of its payload (github.com/microsoft/uf2, "File format").
const BLOCK: usize = 512;
const PAYLOAD: usize = 476;

/// Numbers at the start and the end of a block, and the flag of a block that names its family (same source).
const FIRST: u32 = 0x0A32_4655;
const SECOND: u32 = 0x9E5D_5157;
const LAST: u32 = 0x0AB1_6F30;
const NAMES_FAMILY: u32 = 0x2000;

/// Family of the RP2040 (same source, utils/uf2families.json).
const RP2040: u32 = 0xe48b_ff56;

/// Start of the flash (RP2040 datasheet, section 2.2).
const FLASH: u32 = 0x1000_0000;

/// Holds the UF2 file against the ELF file of the firmware.
pub(crate) fn hold(firmware: &Path, uf2: Option<&str>) -> Result<(), Box<dyn Error>> {
    let uf2 = std::fs::read(uf2.ok_or("name the UF2 file after the part")?)?;
    let flash = contents(&uf2)?;
    compare(&std::fs::read(firmware)?, &flash)?;
    println!("{} bytes from {FLASH:#x} on, for the RP2040: those of the ELF file", flash.len());
    Ok(())
}

/// Returns the bytes of a UF2 file for the RP2040, each at its address.
fn contents(uf2: &[u8]) -> Result<BTreeMap<u32, u8>, Box<dyn Error>> {
    let (blocks, rest) = uf2.as_chunks::<BLOCK>();
    check(!blocks.is_empty() && rest.is_empty(), "a UF2 file of whole blocks")?;
    let mut flash = BTreeMap::new();
    for (number, block) in blocks.iter().enumerate() {
        let word = |at: usize| block.get(at..).and_then(|bytes| bytes.first_chunk()).copied();
        let word = |at| word(at).map_or(0, u32::from_le_bytes);
        check([word(0), word(4), word(508)] == [FIRST, SECOND, LAST], "the numbers around a block")?;
        check(word(8) & NAMES_FAMILY != 0 && word(28) == RP2040, "the family of the RP2040")?;
        let (place, size) = (word(12), word(16) as usize);
        check(
            [word(20) as usize, word(24) as usize] == [number, blocks.len()],
            "the number of a block and of all",
        )?;
        check(size > 0 && size <= PAYLOAD, "the size of a block's payload")?;
        let bytes = block.iter().skip(32).take(size);
        for (address, byte) in (place..).zip(bytes) {
            check(flash.insert(address, *byte).is_none(), "each address in one block")?;
        }
    }
    check(flash.keys().next() == Some(&FLASH), "the start at that of the flash")?;
    Ok(flash)
}

/// Holds the bytes of the flash against the segments of the ELF file. Between them the flash is filled with zeros.
fn compare(elf: &[u8], flash: &BTreeMap<u32, u8>) -> Result<(), Box<dyn Error>> {
    let mut left = flash.clone();
    for segment in segments(elf).ok_or("the firmware is no ELF file of 32 bits")? {
        let from = segment.place as usize;
        let bytes = elf.get(from..from + segment.in_file as usize).ok_or("a segment beyond the ELF file")?;
        for (address, byte) in (segment.stored..).zip(bytes) {
            check(left.remove(&address) == Some(*byte), "each byte of the ELF file in the UF2 file")?;
        }
    }
    check(left.values().all(|byte| *byte == 0), "no other byte in the UF2 file")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Code at the start of the flash, and a word after it whose place in use is in memory.
    const SEGMENTS: [(u32, &[u8]); 2] = [(FLASH, b"boot and code"), (FLASH + 0x100, b"data")];

    fn elf() -> Vec<u8> {
        let mut elf = vec![0; 52 + 64];
        elf[..5].copy_from_slice(b"\x7fELF\x01");
        elf[28] = 52;
        (elf[42], elf[44]) = (32, 2);
        for (n, (address, bytes)) in SEGMENTS.into_iter().enumerate() {
            let words = [1, elf.len() as u32, 0x2000_0000, address, bytes.len() as u32, bytes.len() as u32];
            for (k, word) in words.into_iter().enumerate() {
                let at = 52 + 32 * n + 4 * k;
                elf[at..at + 4].copy_from_slice(&word.to_le_bytes());
            }
            elf.extend(bytes);
        }
        elf
    }

    fn uf2() -> Vec<u8> {
        let blocks = (0..).zip(SEGMENTS).map(|(number, (address, bytes))| {
            let mut block = [0; BLOCK];
            let words = [FIRST, SECOND, NAMES_FAMILY, address, 256, number, 2, RP2040];
            for (k, word) in words.into_iter().enumerate() {
                block[4 * k..4 * k + 4].copy_from_slice(&u32::to_le_bytes(word));
            }
            block[32..32 + bytes.len()].copy_from_slice(bytes);
            block[508..].copy_from_slice(&LAST.to_le_bytes());
            block
        });
        blocks.flatten().collect()
    }

    fn holds(uf2: &[u8]) -> bool {
        contents(uf2).and_then(|flash| compare(&elf(), &flash)).is_ok()
    }

    #[test]
    fn a_uf2_file_of_the_firmware_holds_and_one_that_differs_anywhere_does_not() {
        assert!(holds(&uf2()));
        assert!(!holds(&[]) && !holds(&uf2()[..512]) && !holds(&uf2()[1..]));
        // Each word of a block but the flags, a byte of the code, and a byte beyond it.
        for at in [0, 4, 12, 16, 20, 24, 28, 32, 44, 45, 287, 508, 512 + 32, 512 + 12] {
            let mut changed = uf2();
            changed[at] ^= 1;
            assert!(!holds(&changed), "{at}");
        }
    }
}
