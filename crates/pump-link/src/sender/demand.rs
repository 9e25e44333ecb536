//! The demand of a plan on the link.

use pump_ctl::step::Segment;
use thiserror::Error;

/// Time by which a segment must be at the node before it begins, ms. A pause of the host shorter than this is unseen.
pub const RESERVE_MS: u64 = 200;

/// Bytes of a frame around its segments: header, message, checksum, COBS and zeros.
pub const FRAME_OVERHEAD: usize = 32;

/// A plan that needs its segments faster than the link or the queue can have them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TooFast {
    /// The plan needs more bytes a second than the link carries.
    ///
    /// [`Demand`] tells the need up to the first segment that comes too late, which later segments may exceed. The
    /// least rate that is enough for a whole plan is found by trying rates.
    #[error(
        "the plan needs {needed_bytes_s} bytes a second, and the link carries {allowed_bytes_s}; dose more slowly"
    )]
    Link {
        /// Rate that the plan needs, rounded up, bytes a second. It is more than the link carries.
        needed_bytes_s: u64,
        /// Rate of the link for this axis, bytes a second.
        allowed_bytes_s: u64,
    },
    /// The segments that the queue holds last less than the reserve.
    #[error(
        "the board's queue of {queue} segments lasts {lasts_ms} ms, and {RESERVE_MS} are needed; dose more slowly"
    )]
    Queue {
        /// Number of segments that the queue holds.
        queue: usize,
        /// Shortest time that a full queue lasts, ms.
        lasts_ms: u64,
    },
}

/// A check that the segments of a plan can reach the node in time, with a queue of `Q` segments.
///
/// The first `Q` segments are there before the move begins. Each later one can be sent when there is room for it, and
/// must arrive [`RESERVE_MS`] before its first step is due.
///
/// ```
/// use pump_ctl::step::Segment;
/// use pump_link::sender::{Demand, TooFast};
///
/// // 2,000 segments of 2 ms and 3 bytes each: 1.5 kB/s.
/// let segment = Segment { count: 4, interval: 500, add: 0, frac: 0 };
/// let check = |bytes_s| {
///     let mut demand = Demand::<256>::new(1_000_000, bytes_s);
///     (0..2000).try_for_each(|_| demand.segment(&segment, 3))
/// };
/// assert_eq!(check(2_000), Ok(()));
/// assert!(matches!(check(1_000), Err(TooFast::Link { needed_bytes_s: 1_001.., allowed_bytes_s: 1_000 })));
/// ```
#[derive(Debug, Clone)]
pub struct Demand<const Q: usize> {
    tick_hz: u64,
    bytes_s: u64,
    /// Ticks at which the last `Q` segments end.
    ends: [u64; Q],
    segments: usize,
    /// Tick at which the segment under way ends.
    end: u64,
    /// Tick at which the link is free again.
    free: u64,
    /// Tick since which the link was never free, and the bytes sent since then.
    busy_from: u64,
    busy_bytes: u64,
}

impl<const Q: usize> Demand<Q> {
    /// Makes the check of a plan for a timer of this rate, on a link that carries `bytes_s` bytes a second for this
    /// axis.
    pub const fn new(tick_hz: u32, bytes_s: u32) -> Self {
        Self {
            tick_hz: tick_hz as u64,
            bytes_s: bytes_s as u64,
            ends: [0; Q],
            segments: 0,
            end: 0,
            free: 0,
            busy_from: 0,
            busy_bytes: 0,
        }
    }

    /// Checks the next segment of the plan, which takes `bytes` on the link with its share of the frame.
    ///
    /// # Errors
    ///
    /// Fails with [`TooFast`] if the segment would come too late.
    pub fn segment(&mut self, segment: &Segment, bytes: u32) -> Result<(), TooFast> {
        let begins = self.end;
        self.end = begins.saturating_add(segment.duration().whole);
        let place = self.ends.get_mut(self.segments % Q);
        let room_at = place.map_or(0, |place| core::mem::replace(place, self.end));
        self.segments += 1;
        if self.segments <= Q {
            return Ok(());
        }
        if room_at > self.free {
            (self.free, self.busy_from, self.busy_bytes) = (room_at, room_at, 0);
        }
        self.busy_bytes += u64::from(bytes);
        self.free = self.busy_from.saturating_add(self.busy_bytes * self.tick_hz / self.bytes_s.max(1));
        let due = begins.saturating_sub(RESERVE_MS * self.tick_hz / 1000);
        if room_at >= due {
            let lasts_ms = (begins - room_at) * 1000 / self.tick_hz.max(1);
            return Err(TooFast::Queue { queue: Q, lasts_ms });
        }
        if self.free <= due {
            return Ok(());
        }
        let time = due.saturating_sub(self.busy_from).max(1);
        let needed_bytes_s = (self.busy_bytes * self.tick_hz).div_ceil(time);
        Err(TooFast::Link { needed_bytes_s, allowed_bytes_s: self.bytes_s })
    }
}
