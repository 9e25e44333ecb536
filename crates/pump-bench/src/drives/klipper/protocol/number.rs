//! Numbers of variable length: 7 bits a byte, the highest first.
//!
//! Source: Klipper3d/klipper, `docs/Protocol.md`, "Variable Length Quantities".

use super::error::MessageError;

/// Most bytes of a number.
const BYTES_MOST: usize = 5;

/// Bit that says that further bytes follow.
const MORE: u8 = 0x80;

/// Number of bits that a byte carries.
const BITS: u32 = 7;

/// Bits of the first byte that are both set in a negative number.
const NEGATIVE: u8 = 0x60;

/// Appends a number to `to`. The number is between `i32::MIN` and `u32::MAX`, as [`super::Kind`] sees to.
///
/// A number of n bytes is between -2^(7n - 2) and 3 * 2^(7n - 2) - 1. Five bytes take any.
pub(super) fn put(to: &mut Vec<u8>, number: i64) {
    let fits = |bytes: usize| {
        let quarter = 1_i64 << (BITS as usize * bytes - 2);
        (-quarter..3 * quarter).contains(&number)
    };
    let bytes = (1..BYTES_MOST).find(|bytes| fits(*bytes)).unwrap_or(BYTES_MOST);
    for place in (0..bytes).rev() {
        let low = (number >> (BITS as usize * place)) as u8 & !MORE;
        to.push(if place == 0 { low } else { low | MORE });
    }
}

/// Takes a number from the front of `from`.
///
/// The board sends numbers of 32 bits, and large unsigned ones as negative ones. So the sign is left to the reader:
/// the low 32 bits count.
pub(super) fn take(from: &mut &[u8]) -> Result<u32, MessageError> {
    let mut number = 0_i64;
    for place in 0..BYTES_MOST {
        let (&byte, rest) = from.split_first().ok_or(MessageError::CutOff)?;
        *from = rest;
        if place == 0 && byte & NEGATIVE == NEGATIVE {
            number = -1;
        }
        number = (number << BITS) | i64::from(byte & !MORE);
        if byte & MORE == 0 {
            return Ok(number as u32);
        }
    }
    Err(MessageError::LongNumber { most: BYTES_MOST })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes_of(number: i64) -> Vec<u8> {
        let mut bytes = Vec::new();
        put(&mut bytes, number);
        bytes
    }

    /// The table of `docs/Protocol.md`: the bytes of the numbers from first to last.
    const TABLE: [(i64, i64, usize); 5] = [
        (-32, 95, 1),
        (-4096, 12287, 2),
        (-524_288, 1_572_863, 3),
        (-67_108_864, 201_326_591, 4),
        (-2_147_483_648, 4_294_967_295, 5),
    ];

    #[test]
    fn a_number_takes_as_many_bytes_as_the_documentation_says() {
        for (row, (first, last, bytes)) in TABLE.into_iter().enumerate() {
            for number in [first, last] {
                assert_eq!(bytes_of(number).len(), bytes, "{number}");
            }
            if row + 1 < TABLE.len() {
                assert_eq!(bytes_of(first - 1).len(), bytes + 1, "{first} - 1");
                assert_eq!(bytes_of(last + 1).len(), bytes + 1, "{last} + 1");
            }
        }
    }

    #[test]
    fn a_number_comes_back_at_every_boundary() {
        let near = TABLE.iter().flat_map(|(first, last, _)| [*first, *last]);
        let powers = (0..32).flat_map(|bit| [1_i64 << bit, -(1_i64 << bit)]);
        for number in near.chain(powers).flat_map(|at| at - 2..=at + 2) {
            if !(i64::from(i32::MIN)..=i64::from(u32::MAX)).contains(&number) {
                continue;
            }
            let bytes = bytes_of(number);
            let mut rest = bytes.as_slice();
            assert_eq!(take(&mut rest), Ok(number as u32), "{number} {bytes:02x?}");
            assert!(rest.is_empty(), "{number}");
            for cut in 0..bytes.len() {
                assert_eq!(take(&mut &bytes[..cut]), Err(MessageError::CutOff), "{number} {cut}");
            }
        }
    }

    /// Worked by hand from the description: 7 bits a byte, the highest first, a set high bit on all but the last.
    #[test]
    fn bytes_are_those_of_the_description() {
        for (number, bytes) in [
            (0, &[0x00][..]),
            (95, &[0x5f]),
            (96, &[0x80, 0x60]),
            (-1, &[0x7f]),
            (-32, &[0x60]),
            (-33, &[0xff, 0x5f]),
            (7458, &[0xba, 0x22]),
            (11717, &[0xdb, 0x45]),
            (4_000_000, &[0x81, 0xf4, 0x92, 0x00]),
            (i64::from(u32::MAX), &[0x8f, 0xff, 0xff, 0xff, 0x7f]),
            (i64::from(i32::MIN), &[0xf8, 0x80, 0x80, 0x80, 0x00]),
        ] {
            assert_eq!(bytes_of(number), bytes, "{number}");
        }
    }

    #[test]
    fn a_large_number_may_come_as_a_negative_one() {
        assert_eq!(take(&mut &[0x7f][..]), Ok(u32::MAX));
    }

    #[test]
    fn a_number_without_an_end_is_refused() {
        let error = take(&mut &[0xff; 9][..]).unwrap_err();
        assert_eq!(error.to_string(), "a number has more than 5 bytes");
    }
}
