//! Steps whose intervals grow or shrink evenly.

use super::ticks::Ticks;

/// A run of steps: the first comes `interval` after the step before it, and each interval is `add` longer than the
/// last.
///
/// Step k (from 1) is due k I + add k (k - 1) / 2 after the step before the segment, I being interval and fraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Segment {
    /// Steps; negative in reverse; not zero.
    pub count: i32,
    /// First interval, whole ticks; 2^48 at most.
    pub interval: u64,
    /// Change of the interval from step to step, 2^-32 tick.
    pub add: i64,
    /// Fraction of the first interval, 2^-32 tick.
    pub frac: u32,
}

/// Longest interval, ticks: nine years at 1 MHz.
const MAX_INTERVAL: i128 = 1 << 48;

/// One tick, 2^-32 tick.
const TICK: i128 = 1 << 32;

impl Segment {
    /// 1 forward, -1 in reverse.
    pub fn direction(&self) -> i8 {
        if self.count < 0 { -1 } else { 1 }
    }

    /// Steps without their direction.
    pub fn steps(&self) -> u32 {
        self.count.unsigned_abs()
    }

    /// Tells whether the segment has steps, and every interval is one tick at least and 2^48 at most.
    pub fn is_valid(&self) -> bool {
        let allowed = |interval: i128| (TICK..=MAX_INTERVAL * TICK).contains(&interval);
        let can_be_turned = self.count != i32::MIN && self.add != i64::MIN;
        self.count != 0
            && can_be_turned
            && allowed(self.interval_of(1))
            && allowed(self.interval_of(self.steps()))
    }

    /// The first interval.
    #[inline]
    pub(super) fn first(&self) -> Ticks {
        Ticks { whole: self.interval, frac: self.frac }
    }

    /// The interval before step `k` (from 1), 2^-32 tick.
    pub(super) fn interval_of(&self, k: u32) -> i128 {
        self.first().fixed() + i128::from(self.add) * (i128::from(k) - 1)
    }

    /// Time from the step before the segment to its step `k` (from 1), 2^-32 tick; 0 for `k` 0.
    pub(crate) fn span(&self, k: u32) -> i128 {
        let k = i128::from(k);
        k * self.first().fixed() + i128::from(self.add) * (k * (k - 1) / 2)
    }

    /// Number of the first `limit` steps that are due `elapsed`, in 2^-32 tick, after the step before the segment.
    pub(crate) fn steps_within(&self, elapsed: i128, limit: u32) -> u32 {
        let (mut within, mut beyond) = (0, limit.saturating_add(1));
        while beyond - within > 1 {
            let middle = within + (beyond - within) / 2;
            if self.span(middle) <= elapsed {
                within = middle;
            } else {
                beyond = middle;
            }
        }
        within
    }
}
