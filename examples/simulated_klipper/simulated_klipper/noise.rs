//! A line that loses, doubles and damages bytes.

use super::options::Noise;

/// Line with noise.
#[derive(Debug)]
pub(super) struct NoisyLine {
    noise: Noise,
    state: u64,
}

impl NoisyLine {
    pub(super) fn new(noise: Noise, salt: u64) -> Self {
        Self { noise, state: (noise.seed ^ salt).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1 }
    }

    /// Returns a number from 0 to 1 (xorshift64*, Vigna 2016).
    fn part(&mut self) -> f64 {
        self.state ^= self.state >> 12;
        self.state ^= self.state << 25;
        self.state ^= self.state >> 27;
        (self.state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns what arrives for these bytes.
    pub(super) fn carry(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut arrives = Vec::new();
        for byte in bytes {
            let (part, bit) = (self.part(), 1 << ((8.0 * self.part()) as u32));
            let Noise { lost, doubled, damaged, .. } = self.noise;
            if part < lost {
                continue;
            }
            arrives.push(if part < lost + damaged { byte ^ bit } else { *byte });
            if part >= lost + damaged && part < lost + damaged + doubled {
                arrives.push(*byte);
            }
        }
        arrives
    }
}

#[cfg(test)]
mod tests {
    use super::{Noise, NoisyLine};

    #[test]
    fn as_many_bytes_are_lost_doubled_and_damaged_as_was_said() {
        let bytes = vec![0x55; 100_000];
        assert_eq!(NoisyLine::new(Noise::default(), 1).carry(&bytes), bytes);
        let noise = |lost, doubled, damaged| NoisyLine::new(Noise { lost, doubled, damaged, seed: 7 }, 1);
        let near = |count: usize, part: f64| (count as f64 / 1e5 - part).abs() < 0.002;
        assert!(near(noise(0.02, 0.0, 0.0).carry(&bytes).len(), 0.98));
        assert!(near(noise(0.0, 0.03, 0.0).carry(&bytes).len(), 1.03));
        let damaged = noise(0.0, 0.0, 0.04).carry(&bytes);
        assert!(near(damaged.iter().filter(|byte| **byte != 0x55).count(), 0.04));
    }
}
