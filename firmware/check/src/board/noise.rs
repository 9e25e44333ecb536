//! A line that changes bytes on their way.

use super::random::Random;

/// Frames of which one has a byte changed, on average.
const FRAMES_PER_FLIP: u64 = 8;

/// Line that changes single bytes on their way, at random.
pub(crate) struct Noise {
    random: Random,
    /// Bytes that were changed on the way to the board, and on the way back.
    pub(crate) changed: [u32; 2],
}

impl Noise {
    /// Makes a line whose changes begin with this seed.
    pub(crate) fn new(seed: u64) -> Self {
        Self { random: Random(seed), changed: [0; 2] }
    }

    /// Takes a frame on its way to the board (0) or back (1). One of its bytes may change, its end included.
    pub(crate) fn pass(&mut self, way: usize, bytes: &mut [u8]) {
        if bytes.is_empty() || self.random.below(FRAMES_PER_FLIP) != 0 {
            return;
        }
        let place = self.random.below(bytes.len() as u64) as usize;
        let bits = 1 + self.random.below(255) as u8;
        if let (Some(byte), Some(changed)) = (bytes.get_mut(place), self.changed.get_mut(way)) {
            *byte ^= bits;
            *changed += 1;
        }
    }
}
