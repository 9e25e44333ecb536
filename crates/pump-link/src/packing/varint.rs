//! Integers of variable length, seven bits a byte, the least first (LEB128).

use super::error::PackError;

/// Longest integer, bytes: 128 bits.
pub(super) const MAX_BYTES: usize = 19;

/// Writes a signed integer. Small magnitudes are short, because the sign becomes the last bit (zigzag).
pub(super) fn write(value: i128, to: &mut &mut [u8]) -> Result<(), PackError> {
    let mut rest = ((value << 1) ^ (value >> 127)) as u128;
    loop {
        let low = (rest & 0x7f) as u8;
        rest >>= 7;
        let (place, others) = core::mem::take(to).split_first_mut().ok_or(PackError::Full)?;
        *place = if rest == 0 { low } else { low | 0x80 };
        *to = others;
        if rest == 0 {
            return Ok(());
        }
    }
}

/// Reads a signed integer.
pub(super) fn read(from: &mut &[u8]) -> Result<i128, PackError> {
    let mut value = 0_u128;
    for n in 0..MAX_BYTES {
        let (byte, rest) = from.split_first().ok_or(PackError::Bytes)?;
        *from = rest;
        value |= u128::from(byte & 0x7f) << (7 * n);
        if byte & 0x80 == 0 {
            return Ok((value >> 1) as i128 ^ -((value & 1) as i128));
        }
    }
    Err(PackError::Bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_come_back_and_small_ones_take_a_byte() {
        for value in [0, 1, -1, 63, -64, 64, 1 << 40, -(1 << 90), i128::MAX, i128::MIN] {
            let mut bytes = [0; MAX_BYTES];
            let mut to = &mut bytes[..];
            write(value, &mut to).unwrap();
            let len = MAX_BYTES - to.len();
            assert_eq!(len == 1, (-64..64).contains(&value), "{value}");
            assert_eq!(read(&mut &bytes[..len]), Ok(value));
            assert_eq!(read(&mut &bytes[..len - 1]), Err(PackError::Bytes));
            assert_eq!(write(value, &mut &mut [0; MAX_BYTES][..len - 1]), Err(PackError::Full));
        }
        assert_eq!(read(&mut &[0xff; 30][..]), Err(PackError::Bytes));
    }
}
