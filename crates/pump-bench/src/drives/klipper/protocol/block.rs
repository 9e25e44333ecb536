//! Blocks: length, sequence number, content, checksum and an end mark.
//!
//! Source: Klipper3d/klipper, `docs/Protocol.md`, "Message Blocks".

use crc::{CRC_16_MCRF4XX, Crc};

/// Bytes of a block before its content.
const HEADER: usize = 2;

/// Bytes of a block after its content.
const TRAILER: usize = 3;

/// Fewest bytes of a block.
const LEAST: usize = HEADER + TRAILER;

/// Most bytes of a block.
pub(in crate::drives::klipper) const BLOCK_MOST: usize = 64;

/// Most bytes of a block's content.
pub(in crate::drives::klipper) const CONTENT_MOST: usize = BLOCK_MOST - LEAST;

/// Last byte of a block. A further one may stand before a block.
pub(in crate::drives::klipper) const SYNC: u8 = 0x7e;

/// High bits of every byte with a sequence number.
const SEQUENCE_MARK: u8 = 0x10;

/// Bits of the sequence number.
const SEQUENCE_BITS: u8 = 0x0f;

/// Checksum of a block, whose high byte goes first. The documentation says "16bit CCITT". The firmware starts at 0xffff
/// and goes from the low bit to the high bit (`src/generic/crc16_ccitt.c`), as the catalogue's CRC-16/MCRF4XX does.
const CHECKSUM: Crc<u16> = Crc::<u16>::new(&CRC_16_MCRF4XX);

/// Returns the block of a content, with the low 4 bits of a sequence number. The content has [`CONTENT_MOST`] bytes at
/// most, as [`super::Format::encode`] sees to.
pub(in crate::drives::klipper) fn block(sequence: u8, content: &[u8]) -> Vec<u8> {
    let content = content.get(..CONTENT_MOST).unwrap_or(content);
    let mut bytes = Vec::with_capacity(LEAST + content.len());
    bytes.push((LEAST + content.len()) as u8);
    bytes.push(SEQUENCE_MARK | sequence & SEQUENCE_BITS);
    bytes.extend_from_slice(content);
    let checksum = CHECKSUM.checksum(&bytes);
    bytes.extend_from_slice(&checksum.to_be_bytes());
    bytes.push(SYNC);
    bytes
}

/// Block that came from the board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::drives::klipper) struct Block {
    /// Sequence number of the block that the board takes next, 0 to 15.
    pub(in crate::drives::klipper) sequence: u8,
    /// Content. It is empty in a mere acknowledgement.
    pub(in crate::drives::klipper) content: Vec<u8>,
}

/// Reader of blocks from a stream of bytes that may be torn, doubled or corrupt.
#[derive(Debug, Default)]
pub(in crate::drives::klipper) struct BlockReader {
    /// Bytes that no block has yet. They are fewer than those of the largest block once [`Self::next`] has no more.
    bytes: Vec<u8>,
    /// Number of bytes that belong to no block.
    skipped: u64,
    /// Number of blocks whose checksum failed.
    corrupt: u64,
}

/// Finding at the front of the bytes.
enum Found {
    Block { length: usize },
    More,
    Corrupt,
    Nothing,
}

impl BlockReader {
    /// Takes bytes that have come.
    pub(in crate::drives::klipper) fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Returns the next whole block. `None` until further bytes come.
    ///
    /// Where no block begins, one byte is skipped. So a block whose forerunner lost its end is found all the same.
    pub(in crate::drives::klipper) fn next(&mut self) -> Option<Block> {
        let mut at = 0;
        let block = loop {
            let bytes = self.bytes.get(at..).unwrap_or_default();
            match found(bytes) {
                Found::Block { length } => {
                    let sequence = bytes[1] & SEQUENCE_BITS;
                    let content = bytes.get(HEADER..length - TRAILER).unwrap_or_default().to_vec();
                    at += length;
                    break Some(Block { sequence, content });
                }
                Found::More => break None,
                Found::Corrupt => {
                    self.corrupt += 1;
                    self.skipped += 1;
                    at += 1;
                }
                Found::Nothing => {
                    // An end mark before a block is allowed, and nothing is lost with it.
                    self.skipped += u64::from(bytes[0] != SYNC);
                    at += 1;
                }
            }
        };
        self.bytes.drain(..at);
        block
    }

    /// Gives up a block whose rest has not come for long: its length may be a byte that was damaged. Blocks within it
    /// are found.
    pub(in crate::drives::klipper) fn give_up(&mut self) {
        if !self.bytes.is_empty() {
            self.bytes.remove(0);
            self.skipped += 1;
        }
    }

    /// Returns the number of bytes that wait for the rest of their block.
    #[cfg(test)]
    pub(super) fn waiting(&self) -> usize {
        self.bytes.len()
    }

    /// Returns the number of bytes that belong to no block, so far.
    #[cfg(test)]
    pub(in crate::drives::klipper) fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Returns the number of blocks whose checksum failed, so far.
    pub(in crate::drives::klipper) fn corrupt(&self) -> u64 {
        self.corrupt
    }
}

/// Returns the finding at the front of `bytes`.
fn found(bytes: &[u8]) -> Found {
    let (length, sequence) = match bytes {
        [] => return Found::More,
        [length] => (usize::from(*length), SEQUENCE_MARK),
        [length, sequence, ..] => (usize::from(*length), *sequence),
    };
    if !(LEAST..=BLOCK_MOST).contains(&length) || sequence & !SEQUENCE_BITS != SEQUENCE_MARK {
        return Found::Nothing;
    }
    let Some(bytes) = bytes.get(..length) else { return Found::More };
    match bytes.split_last_chunk() {
        Some((body, [high, low, SYNC])) => {
            if CHECKSUM.checksum(body) == u16::from_be_bytes([*high, *low]) {
                Found::Block { length }
            } else {
                Found::Corrupt
            }
        }
        _ => Found::Nothing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_has_its_published_check() {
        // Catalogue of parametrised CRC algorithms, CRC-16/MCRF4XX: the check of "123456789" is 0x6f91.
        assert_eq!(CHECKSUM.checksum(b"123456789"), 0x6f91);
    }
}
