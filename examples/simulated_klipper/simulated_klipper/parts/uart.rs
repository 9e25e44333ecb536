//! The line to the drivers, made by the board's software: each byte has a start bit and a stop bit.

/// Line to the drivers.
#[derive(Debug)]
pub(in super::super) struct Uart {
    /// Ticks of a bit.
    bit: u64,
    /// True if the pins are those at which the drivers are.
    pub(in super::super) is_wired: bool,
    /// Answer on its way, and the tick at which the board tells it.
    answer: Option<(u64, Vec<u8>)>,
}

/// Bits of a byte on the line.
const BITS: usize = 10;

/// Bits for which the board waits for an answer.
const PATIENCE: u64 = 64;

/// Part of a second from the command to its first bit: 200 us.
const BEFORE: u64 = 5000;

/// Returns the bytes behind these bits, or `None` if a start or stop bit is not as it should be.
fn unpacked(packed: &[u8]) -> Option<Vec<u8>> {
    let bit = |place: usize| packed.get(place / 8).is_some_and(|byte| byte >> (place % 8) & 1 == 1);
    (0..packed.len() * 8 / BITS)
        .map(|n| {
            let first = n * BITS;
            let is_framed = !bit(first) && bit(first + 9);
            is_framed.then(|| (0..8).fold(0, |byte, k| byte | u8::from(bit(first + 1 + k)) << k))
        })
        .collect()
}

/// Returns bytes as bits, each between its start and stop bit, in `size` bytes.
fn packed(bytes: &[u8], size: usize) -> Vec<u8> {
    let mut packed = vec![0; size];
    let bits = bytes.iter().flat_map(|byte| {
        let data = (0..8).map(|k| byte >> k & 1 == 1);
        std::iter::once(false).chain(data).chain(std::iter::once(true)).collect::<Vec<_>>()
    });
    for (place, bit) in bits.enumerate().filter(|(place, _)| place / 8 < size) {
        packed[place / 8] |= u8::from(bit) << (place % 8);
    }
    packed
}

impl Uart {
    pub(in super::super) fn new(bit: u32, is_wired: bool) -> Self {
        Self { bit: u64::from(bit), is_wired, answer: None }
    }

    /// Sends bits, and asks for `size` bytes of an answer. A line that is busy drops the request, as the firmware does.
    /// `answers` are the drivers.
    pub(in super::super) fn send(
        &mut self,
        bits: &[u8],
        size: usize,
        (now, hz): (u64, u32),
        answers: impl FnOnce(&[u8]) -> Option<Vec<u8>>,
    ) {
        if self.answer.is_some() {
            return;
        }
        let reply = unpacked(bits).filter(|_| self.is_wired).and_then(|datagram| answers(&datagram));
        let sent = now + u64::from(hz) / BEFORE + 8 * bits.len() as u64 * self.bit;
        self.answer = Some(match reply {
            _ if size == 0 => (sent, Vec::new()),
            // The drivers answer after 8 bits.
            Some(reply) => (sent + (8 + 8 * size as u64) * self.bit, packed(&reply, size)),
            None => (sent + PATIENCE * self.bit, Vec::new()),
        });
    }

    /// Returns the tick at which an answer is told.
    pub(in super::super) fn next(&self) -> Option<u64> {
        self.answer.as_ref().map(|(at, _)| *at)
    }

    /// Returns the answer.
    pub(in super::super) fn take(&mut self) -> Vec<u8> {
        self.answer.take().map(|(_, bits)| bits).unwrap_or_default()
    }

    /// Forgets what is on its way, at a shutdown.
    pub(in super::super) fn forget(&mut self) {
        self.answer = None;
    }
}

#[cfg(test)]
mod tests {
    use super::{Uart, packed, unpacked};

    #[test]
    fn bytes_are_between_a_start_bit_and_a_stop_bit() {
        // 0xf5 from its lowest bit: 0 10101111 1, then 0x00: 0 00000000 1.
        let bits = packed(&[0xf5, 0x00], 3);
        assert_eq!(bits, [0b1110_1010, 0b0000_0011, 0b1000]);
        assert_eq!(unpacked(&packed(&[0xf5, 0, 6, 0x5c], 5)), Some(vec![0xf5, 0, 6, 0x5c]));
        assert_eq!(unpacked(&[0; 5]), None);
    }

    #[test]
    fn an_answer_comes_after_the_bits_and_silence_is_told_too() {
        let mut uart = Uart::new(25, true);
        uart.send(&packed(&[1, 2, 3, 4], 5), 10, (1000, 1_000_000), |datagram| {
            assert_eq!(datagram, [1, 2, 3, 4]);
            Some(vec![9; 8])
        });
        // 200 us, 40 bits, 8 bits, 80 bits.
        assert_eq!(uart.next(), Some(1000 + 200 + 128 * 25));
        uart.send(&[0xff], 10, (1000, 1_000_000), |_| panic!("the line is busy"));
        assert_eq!(unpacked(&uart.take()), Some(vec![9; 8]));
        uart.send(&packed(&[1, 2, 3, 4], 5), 10, (1000, 1_000_000), |_| None);
        assert_eq!(uart.take(), Vec::<u8>::new());
        let mut elsewhere = Uart::new(25, false);
        elsewhere.send(&packed(&[1], 2), 10, (0, 1_000_000), |_| panic!("no driver is there"));
        assert!(elsewhere.take().is_empty());
    }
}
