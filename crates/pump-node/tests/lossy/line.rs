//! One direction of a serial line that loses, delays, doubles and corrupts.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::rng::Rng;

/// Time of a byte at 460,800 baud, us, rounded up.
const BYTE_US: u64 = 22;

/// How bad a line is. All but the latency are probabilities of a frame.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Badness {
    pub(crate) latency_us: u64,
    pub(crate) lost: f64,
    pub(crate) doubled: f64,
    pub(crate) delayed: f64,
    pub(crate) corrupted: f64,
}

#[derive(Debug, Default)]
pub(crate) struct Line {
    /// Bytes by the time at which they arrive, us, and the order in which they were sent.
    arriving: BinaryHeap<Reverse<(u64, u64, u8)>>,
    order: u64,
    free_us: u64,
    /// True while the cable is pulled.
    pub(crate) cut: bool,
}

impl Line {
    pub(crate) fn send(&mut self, bytes: &[u8], now_us: u64, badness: Badness, rng: &mut Rng) {
        let from = now_us.max(self.free_us);
        self.free_us = from + bytes.len() as u64 * BYTE_US;
        if self.cut || rng.chance(badness.lost) {
            return;
        }
        let delay = if rng.chance(badness.delayed) { rng.within(1_000, 120_000) } else { 0 };
        let from = from + badness.latency_us + delay;
        let mut bytes = bytes.to_vec();
        if rng.chance(badness.corrupted) {
            for _ in 0..rng.within(1, 4) {
                let place = rng.within(0, bytes.len() as u64 - 1) as usize;
                match rng.within(0, 2) {
                    0 => bytes[place] ^= 1 << rng.within(0, 7),
                    1 => bytes[place] = rng.next() as u8,
                    _ => drop(bytes.remove(place)),
                }
            }
        }
        self.put(&bytes, from);
        if rng.chance(badness.doubled) {
            self.put(&bytes, from + rng.within(0, 120_000));
        }
    }

    pub(crate) fn put(&mut self, bytes: &[u8], from_us: u64) {
        for (n, byte) in (1..).zip(bytes) {
            self.arriving.push(Reverse((from_us + n * BYTE_US, self.order, *byte)));
            self.order += 1;
        }
    }

    pub(crate) fn next_at(&self) -> Option<u64> {
        self.arriving.peek().map(|Reverse((at, ..))| *at)
    }

    pub(crate) fn take(&mut self, now_us: u64) -> Option<u8> {
        let due = self.next_at()? <= now_us;
        due.then(|| self.arriving.pop().map(|Reverse((.., byte))| byte)).flatten()
    }

    pub(crate) fn pull(&mut self) {
        self.cut = true;
        self.arriving.clear();
    }
}
