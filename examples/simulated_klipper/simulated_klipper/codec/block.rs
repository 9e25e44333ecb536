//! Message blocks: length, sequence, content, checksum and sync byte (docs/Protocol.md, "Message Blocks").

/// Bytes of a block without content, and of the largest one.
const SIZES: std::ops::RangeInclusive<usize> = 5..=64;

/// High bits of the sequence byte.
const SEQUENCE: u8 = 0x10;

/// Last byte of a block.
const SYNC: u8 = 0x7e;

/// Returns the checksum of a block's bytes: the CCITT polynomial, low bits first, from all ones.
fn checksum(bytes: &[u8]) -> u16 {
    let mut sum = 0xffff_u16;
    for byte in bytes {
        sum ^= u16::from(*byte);
        for _ in 0..8 {
            let carry = sum & 1;
            sum >>= 1;
            if carry == 1 {
                // x^16 + x^12 + x^5 + 1, mirrored.
                sum ^= 0x8408;
            }
        }
    }
    sum
}

/// Returns the block of some content, with a sequence number of 4 bits. No content makes an acknowledgement.
pub(in super::super) fn framed(sequence: u8, content: &[u8]) -> Vec<u8> {
    let mut block = vec![(content.len() + SIZES.start()) as u8, SEQUENCE | sequence & 0xf];
    block.extend(content);
    block.extend(checksum(&block).to_be_bytes());
    block.push(SYNC);
    block
}

/// Result that a byte completes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in super::super) enum Heard {
    /// Block in order, with its content.
    Block(Vec<u8>),
    /// Block that is damaged, or out of order: the host is to send again.
    Wrong,
}

/// Receiver of blocks. It takes them in order and refuses all others.
#[derive(Debug, Default)]
pub(in super::super) struct Inlet {
    held: Vec<u8>,
    /// Sequence number of the block that is awaited, which is also that of the board's blocks.
    pub(in super::super) awaited: u8,
    /// True while bytes are dropped up to the next sync byte.
    is_lost: bool,
    /// True from a damaged block to a whole one. A board complains once of the bytes between.
    has_complained: bool,
}

impl Inlet {
    /// Takes a byte in. A damaged block may hide whole ones, so that a byte may complete several.
    pub(in super::super) fn take(&mut self, byte: u8) -> Vec<Heard> {
        self.held.push(byte);
        let mut heard = Vec::new();
        while let Some(found) = self.look() {
            heard.extend(found);
        }
        heard
    }

    /// Looks at the bytes that are held. Returns `None` if more are needed.
    fn look(&mut self) -> Option<Option<Heard>> {
        if self.is_lost {
            let sync = self.held.iter().position(|byte| *byte == SYNC);
            self.is_lost = sync.is_none();
            self.held.drain(..sync.map_or(self.held.len(), |place| place + 1));
            return (!self.is_lost).then_some(None);
        }
        let length = usize::from(*self.held.first()?);
        if length == usize::from(SYNC) {
            // A block may have sync bytes before it.
            self.held.remove(0);
            return Some(None);
        }
        let is_header =
            SIZES.contains(&length) && self.held.get(1).is_none_or(|byte| byte & 0xf0 == SEQUENCE);
        if !is_header {
            return Some(self.lose());
        }
        let (inner, trailer) = self.held.get(..length)?.split_at(length - 3);
        if trailer[2] != SYNC || checksum(inner).to_be_bytes() != trailer[..2] {
            return Some(self.lose());
        }
        let (sequence, content) = (inner[1] & 0xf, inner[2..].to_vec());
        self.held.drain(..length);
        self.has_complained = false;
        if sequence != self.awaited {
            return Some(Some(Heard::Wrong));
        }
        self.awaited = (self.awaited + 1) & 0xf;
        Some(Some(Heard::Block(content)))
    }

    /// Drops what is damaged, up to the next sync byte.
    fn lose(&mut self) -> Option<Heard> {
        self.is_lost = true;
        (!std::mem::replace(&mut self.has_complained, true)).then_some(Heard::Wrong)
    }
}

#[cfg(test)]
mod tests {
    use super::{Heard, Inlet, checksum, framed};

    fn heard(inlet: &mut Inlet, bytes: &[u8]) -> Vec<Heard> {
        bytes.iter().flat_map(|byte| inlet.take(*byte)).collect()
    }

    #[test]
    fn the_checksum_is_that_of_the_catalogue() {
        // CRC-16/MCRF4XX of the catalogue of parametrised CRC algorithms (reveng.sourceforge.io).
        assert_eq!(checksum(b"123456789"), 0x6f91);
    }

    #[test]
    fn a_block_has_the_documented_form() {
        let block = framed(3, &[1, 0, 40]);
        assert_eq!((block[0], block[1], &block[2..5], block[7]), (8, 0x13, [1, 0, 40].as_slice(), 0x7e));
        // The least block has 5 bytes and the largest 64.
        assert_eq!((framed(0, &[]).len(), framed(0, &[0; 59]).len()), (5, 64));
    }

    #[test]
    fn blocks_in_order_are_taken_and_others_refused() {
        let mut inlet = Inlet::default();
        assert_eq!(heard(&mut inlet, &framed(0, &[1])), [Heard::Block(vec![1])]);
        assert_eq!(heard(&mut inlet, &framed(0, &[1])), [Heard::Wrong]);
        assert_eq!(heard(&mut inlet, &framed(2, &[1])), [Heard::Wrong]);
        let (extra, next) = ([0x7e, 0x7e], framed(1, &[0x7e, 2]));
        assert_eq!(heard(&mut inlet, &[&extra, next.as_slice()].concat()), [Heard::Block(vec![0x7e, 2])]);
        assert_eq!(inlet.awaited, 2);
    }

    #[test]
    fn one_complaint_follows_a_damaged_block_and_the_next_whole_one_is_taken() {
        let good = framed(0, &[5, 6, 7]);
        for place in 0..good.len() {
            let mut inlet = Inlet::default();
            let mut bad = good.clone();
            bad[place] ^= 0x21;
            // A wrong length may swallow the begin of the block that follows.
            let sent: Vec<u8> = [vec![bad], vec![good.clone(); 7]].concat().concat();
            let heard = heard(&mut inlet, &sent);
            assert!(heard.contains(&Heard::Block(vec![5, 6, 7])), "{place}: {heard:?}");
            assert!(heard.contains(&Heard::Wrong), "{place}: {heard:?}");
        }
        let mut inlet = Inlet::default();
        assert_eq!(heard(&mut inlet, &[1, 2, 3, 0x7e, 1, 2, 0x7e]), [Heard::Wrong]);
        assert_eq!(heard(&mut inlet, &good), [Heard::Block(vec![5, 6, 7])]);
    }
}
