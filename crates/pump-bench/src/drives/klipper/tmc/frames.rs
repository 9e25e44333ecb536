//! Bytes as bits on the wire: a start bit, eight bits from the lowest, and a stop bit.
//!
//! The board sends and samples bits, and knows no bytes: it takes them from the lowest bit of the first byte on
//! (Klipper3d/klipper, `src/tmcuart.c`).

/// Bits of a byte on the wire.
const FRAME: usize = 10;

/// Returns the number of bytes that hold the bits of so many bytes on the wire.
pub(super) const fn packed_len(bytes: usize) -> usize {
    (bytes * FRAME).div_ceil(8)
}

/// Returns bytes as bits on the wire. A rest of the last byte is the level of an idle wire.
pub(super) fn pack(bytes: &[u8]) -> Vec<u8> {
    let mut packed = vec![0xff; packed_len(bytes.len())];
    let frame = |byte: &u8| u16::from(*byte) << 1 | 1 << (FRAME - 1);
    for (place, byte) in bytes.iter().enumerate() {
        for bit in (0..FRAME).filter(|bit| frame(byte) >> bit & 1 == 0) {
            let at = place * FRAME + bit;
            if let Some(byte) = packed.get_mut(at / 8) {
                *byte &= !(1 << (at % 8));
            }
        }
    }
    packed
}

/// Returns the bytes of `count` frames. `None` if bits are missing, or a start or stop bit is not what it should be.
pub(super) fn unpack(packed: &[u8], count: usize) -> Option<Vec<u8>> {
    let bit = |at: usize| packed.get(at / 8).map(|byte| byte >> (at % 8) & 1);
    (0..count)
        .map(|place| {
            let first = place * FRAME;
            let frame =
                (0..FRAME).try_fold(0_u16, |frame, at| Some(frame | u16::from(bit(first + at)?) << at))?;
            let is_framed = frame & 1 == 0 && frame >> (FRAME - 1) == 1;
            is_framed.then_some((frame >> 1) as u8)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked by hand: 0xf5 is 0 1010 1111 1 on the wire, 0x00 is 0 0000 0000 1.
    #[test]
    fn bytes_stand_between_a_start_bit_and_a_stop_bit() {
        assert_eq!(pack(&[0xf5]), [0b1110_1010, 0b1111_1111]);
        assert_eq!(pack(&[0xf5, 0x00]), [0b1110_1010, 0b0000_0011, 0b1111_1000]);
        assert_eq!((packed_len(4), packed_len(8)), (5, 10));
    }

    #[test]
    fn every_byte_comes_back_and_a_broken_frame_does_not() {
        let bytes: Vec<u8> = (0..=255).collect();
        let packed = pack(&bytes);
        assert_eq!(unpack(&packed, bytes.len()), Some(bytes.clone()));
        assert_eq!(unpack(&packed, bytes.len() + 1), None);
        for (at, is_edge) in (0..20).map(|at| (at, [0, 9].contains(&(at % 10)))) {
            let mut broken = packed.clone();
            broken[at / 8] ^= 1 << (at % 8);
            assert_eq!(unpack(&broken, bytes.len()).is_none(), is_edge, "bit {at}");
        }
        assert_eq!(unpack(&[], 0), Some(Vec::new()));
    }
}
