//! Datagrams of a TMC2209 and their checksum (datasheet, chapters 4.1 and 4.2).

/// First byte of a request. Its low half is the sync nibble, by which the driver measures the rate.
///
/// The high half is free, and counts for the checksum. With its lowest bit set the wire changes at each of the first
/// six bits, and the board measures its own rate there (Klipper3d/klipper, `src/tmcuart.c`).
const SYNC: u8 = 0xf5;

/// First byte of an answer.
const ANSWER_SYNC: u8 = 0x05;

/// Address of the one who asks.
const MASTER: u8 = 0xff;

/// Bit of a register's number that makes a request a write.
const WRITE: u8 = 0x80;

/// Number of bytes of an answer.
pub(super) const ANSWER_BYTES: usize = 8;

/// Returns the checksum of bytes: the polynomial x^8 + x^2 + x + 1, over the bits of each byte from the lowest.
fn checksum(bytes: &[u8]) -> u8 {
    let bits = bytes.iter().flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1));
    bits.fold(0, |sum: u8, bit| (sum << 1) ^ if sum >> 7 == bit { 0 } else { 0x07 })
}

/// Returns the request for a register of the driver at an address.
pub(super) fn read(address: u8, register: u8) -> Vec<u8> {
    sealed(vec![SYNC, address, register & !WRITE])
}

/// Returns the request that a register of the driver at an address becomes a value.
pub(super) fn write(address: u8, register: u8, value: u32) -> Vec<u8> {
    let mut bytes = vec![SYNC, address, register | WRITE];
    bytes.extend(value.to_be_bytes());
    sealed(bytes)
}

/// Returns the value that an answer tells of a register. `None` if it is damaged or tells of another register.
pub(super) fn answer(bytes: &[u8], register: u8) -> Option<u32> {
    let (sum, inner) = bytes.split_last()?;
    match inner {
        [ANSWER_SYNC, MASTER, told, a, b, c, d] if *told == register && checksum(inner) == *sum => {
            Some(u32::from_be_bytes([*a, *b, *c, *d]))
        }
        _ => None,
    }
}

/// Returns the answer of a driver whose register has a value.
#[cfg(test)]
pub(super) fn answer_of(register: u8, value: u32) -> Vec<u8> {
    let [a, b, c, d] = value.to_be_bytes();
    sealed(vec![ANSWER_SYNC, MASTER, register, a, b, c, d])
}

/// Returns bytes with their checksum.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.push(checksum(&bytes));
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The datasheet's serial rule, chapter 4.2, written bit by bit: the new bit 0 is bit 7, and the new bits 1 and 2
    /// take it too.
    fn checksum_by_bits(bytes: &[u8]) -> u8 {
        let mut register = [0_u8; 8];
        for byte in bytes {
            for place in 0..8 {
                let fed = register[7] ^ (byte >> place) & 1;
                register.rotate_right(1);
                register[0] = fed;
                register[1] ^= fed;
                register[2] ^= fed;
            }
        }
        (0..8).map(|place| register[place] << place).sum()
    }

    #[test]
    fn checksums_are_those_of_the_serial_rule() {
        let mut number = 1_u32;
        for length in 0..64 {
            let bytes: Vec<u8> = (0..length)
                .map(|_| {
                    number = number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (number >> 24) as u8
                })
                .collect();
            assert_eq!(checksum(&bytes), checksum_by_bits(&bytes), "{bytes:02x?}");
        }
    }

    /// Bytes of real drivers that others published: a request and the answer of a TMC2209 (Chr157i4n,
    /// TMC2209_Raspberry_Pi, wiki page "UART"), the write of CHOPCONF (community.st.com), and the answer of a TMC2300
    /// with the same wire (wiki.kurokesu.com, "Reading and writing TMC2300 registers").
    #[test]
    fn datagrams_are_those_of_real_drivers() {
        assert_eq!(checksum(&[0x55, 0x00, 0x06]), 0xe8);
        let ioin = [0x05, 0xff, 0x06, 0x21, 0x00, 0x02, 0x41, 0x9d];
        assert_eq!(answer(&ioin, 0x06), Some(0x2100_0241));
        assert_eq!(checksum(&[0x05, 0x00, 0xec, 0x10, 0x00, 0x00, 0x53]), 0x9c);
        assert_eq!(answer(&[5, 255, 16, 0, 0, 0, 0, 157], 16), Some(0));
    }

    #[test]
    fn requests_are_those_of_the_datasheet() {
        // Chapter 4.1.1 and 4.1.2: sync, address, register with its write bit, data from the highest byte, checksum.
        let read = read(2, 0x6f);
        assert_eq!((read.len(), &read[..3]), (4, &[0xf5, 2, 0x6f][..]));
        assert_eq!(read[3], checksum_by_bits(&read[..3]));
        let write = write(1, 0x10, 0x0102_0304);
        assert_eq!((write.len(), &write[..7]), (8, &[0xf5, 1, 0x90, 1, 2, 3, 4][..]));
        assert_eq!(write[7], checksum_by_bits(&write[..7]));
    }

    #[test]
    fn damaged_and_foreign_answers_tell_nothing() {
        let good = [0x05, 0xff, 0x06, 0x21, 0x00, 0x02, 0x41, 0x9d];
        for bit in 0..64 {
            let mut bytes = good;
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(answer(&bytes, 0x06), None, "bit {bit}");
        }
        assert_eq!(answer(&good, 0x07), None);
        assert_eq!(answer(&good[..7], 0x06), None);
        assert_eq!(answer(&[], 0x06), None);
        // An own request that comes back, as from a wire without a driver, is none.
        assert_eq!(answer(&write(0xff, 0x06, 0), 0x06), None);
    }
}
