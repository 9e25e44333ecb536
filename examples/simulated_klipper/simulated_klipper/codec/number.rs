//! Variable length quantities: whole numbers in one to five bytes (docs/Protocol.md, "Variable Length Quantities").

/// Appends a number. The firmware takes its 32 bits for a signed number, so that 2^32 - 1 has one byte, as -1 has.
pub(super) fn put(bytes: &mut Vec<u8>, number: u32) {
    let signed = i64::from(number.cast_signed());
    let fits = |groups: u32| {
        let quarter = 1_i64 << (7 * groups - 2);
        (-quarter..3 * quarter).contains(&signed)
    };
    let groups = (1..5).find(|groups| fits(*groups)).unwrap_or(5);
    for group in (0..groups).rev() {
        let more = if group > 0 { 0x80 } else { 0 };
        bytes.push((signed >> (7 * group)) as u8 & 0x7f | more);
    }
}

/// Takes a number from the front of `bytes`, or `None` if they end within it.
pub(super) fn take(bytes: &mut &[u8]) -> Option<u32> {
    let mut number = 0_i64;
    for place in 0.. {
        let (first, rest) = bytes.split_first()?;
        *bytes = rest;
        let group = i64::from(first & 0x7f);
        // The upper quarter of the first group stands for negative numbers.
        number = if place == 0 && group >= 0x60 { group - 0x80 } else { (number << 7) | group };
        number = i64::from(number as i32);
        if first & 0x80 == 0 {
            return Some(number as u32);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::{put, take};

    fn bytes(number: i64) -> Vec<u8> {
        let mut bytes = Vec::new();
        put(&mut bytes, number as u32);
        bytes
    }

    #[test]
    fn numbers_have_as_many_bytes_as_the_documentations_table_says() {
        let table = [
            (-32, 95, 1),
            (-4096, 12_287, 2),
            (-524_288, 1_572_863, 3),
            (-67_108_864, 201_326_591, 4),
            (-2_147_483_648, 2_147_483_647, 5),
        ];
        let mut before: Option<(i64, i64)> = None;
        for (least, most, size) in table {
            assert_eq!((bytes(least).len(), bytes(most).len()), (size, size), "{least} {most}");
            if let Some((inner_least, inner_most)) = before {
                assert_eq!((bytes(inner_least - 1).len(), bytes(inner_most + 1).len()), (size, size));
            }
            before = Some((least, most));
        }
    }

    #[test]
    fn numbers_come_back_as_they_were() {
        let edges =
            [0, 1, -1, 95, 96, -32, -33, 12_287, 12_288, 7458, 4_000_000, i64::from(u32::MAX), 1 << 31];
        for number in edges {
            let bytes = bytes(number);
            assert_eq!(take(&mut bytes.as_slice()), Some(number as u32), "{number}");
            assert_eq!(take(&mut &bytes[..bytes.len() - 1]), None);
        }
        // A host may send a large number without a sign in five bytes.
        assert_eq!(take(&mut [0x8f, 0xff, 0xff, 0xff, 0x7f].as_slice()), Some(u32::MAX));
    }
}
