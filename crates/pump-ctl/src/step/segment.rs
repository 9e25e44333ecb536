//! The segment: steps whose intervals grow or shrink evenly.

use super::direction::Direction;
use super::ticks::Ticks;

/// A run of steps whose intervals change evenly.
///
/// The first step comes `interval` after the step before the segment, and each interval is `add` longer than
/// the last. Step k (from 1) is due k I + add k (k - 1) / 2 after the step before the segment. I is interval
/// and fraction.
///
/// ```
/// use pump_ctl::step::{Direction, Segment};
///
/// // Intervals of 1000, 999.5 and 999 ticks.
/// let reverse = Segment { count: -3, interval: 1000, add: -(1 << 31), frac: 0 };
/// assert!(reverse.is_valid());
/// assert_eq!((reverse.steps(), reverse.direction()), (3, Direction::Reverse));
/// // No interval may be shorter than a tick.
/// assert!(!Segment { interval: 0, ..reverse }.is_valid());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Segment {
    /// Number of steps. Negative in reverse, and not zero.
    pub count: i32,
    /// First interval, whole ticks. It is 2^48 at most.
    pub interval: u64,
    /// Change of the interval from step to step, 2^-32 tick.
    pub add: i64,
    /// Fraction of the first interval, 2^-32 tick.
    pub frac: u32,
}

/// Longest interval, ticks: nine years at 1 MHz.
pub(in crate::step) const MAX_INTERVAL: u64 = 1 << 48;

/// One tick, in 2^-32 tick.
const TICK: i128 = 1 << 32;

impl Segment {
    /// Returns the direction of the steps.
    pub fn direction(&self) -> Direction {
        if self.count < 0 { Direction::Reverse } else { Direction::Forward }
    }

    /// Returns the number of steps without their direction.
    pub fn steps(&self) -> u32 {
        self.count.unsigned_abs()
    }

    /// Returns true if the segment has steps, and every interval is one tick at least and 2^48 ticks at most.
    pub fn is_valid(&self) -> bool {
        let allowed = |interval: i128| (TICK..=i128::from(MAX_INTERVAL) * TICK).contains(&interval);
        let can_be_turned = self.count != i32::MIN && self.add != i64::MIN;
        self.count != 0
            && can_be_turned
            && allowed(self.interval_of(1))
            && allowed(self.interval_of(self.steps()))
    }

    /// Returns the segment for [`super::Stepper::push_valid`], or `None` if it is not [valid](Self::is_valid).
    pub fn validated(self) -> Option<ValidSegment> {
        self.is_valid().then_some(ValidSegment(self))
    }

    /// Returns the interval before step `k` of the segment, 1 for the first. [`super::Brake::descent`] begins
    /// with it.
    ///
    /// The segment must be valid and `k` one of its steps.
    pub fn interval_before(&self, k: u32) -> Ticks {
        Ticks::of_fixed(self.interval_of(k))
    }

    /// Returns the time from the step before the segment to its last step. The segment must be valid.
    ///
    /// ```
    /// use pump_ctl::step::{Segment, Ticks};
    ///
    /// // Intervals of 1000, 999.5 and 999 ticks.
    /// let segment = Segment { count: 3, interval: 1000, add: -(1 << 31), frac: 0 };
    /// assert_eq!(segment.duration(), Ticks { whole: 2998, frac: 1 << 31 });
    /// ```
    pub fn duration(&self) -> Ticks {
        Ticks::of_fixed(self.span(self.steps()))
    }

    /// Returns the intervals of the segment in whole ticks, for a PIO or a DMA channel. The segment must be
    /// valid.
    ///
    /// `carry` is the fraction of a tick that the intervals before have left over. Begin a move with
    /// [`Segment::CARRY`]. The sums of the intervals are then the deadlines of [`super::Stepper`].
    ///
    /// ```
    /// use pump_ctl::step::Segment;
    ///
    /// let mut carry = Segment::CARRY;
    /// let segment = Segment { count: 3, interval: 1000, add: -(1 << 31), frac: 0 };
    /// assert!(segment.intervals(&mut carry).eq([1000, 1000, 999]));
    /// assert!(segment.intervals(&mut carry).eq([1000, 999, 999]));
    /// ```
    pub fn intervals<'a>(&self, carry: &'a mut u32) -> Intervals<'a> {
        Intervals::new(self, carry)
    }

    /// Carry at the start of a move, 2^-32 tick: half a tick, by which cut times are rounded.
    pub const CARRY: u32 = 1 << 31;

    /// Returns the first interval.
    #[inline]
    pub(in crate::step) fn first(&self) -> Ticks {
        Ticks { whole: self.interval, frac: self.frac }
    }

    /// Returns the interval before step `k` (from 1), 2^-32 tick.
    pub(in crate::step) fn interval_of(&self, k: u32) -> i128 {
        self.first().fixed() + times(self.add, k.wrapping_sub(1))
    }

    /// Returns the time from the step before the segment to its step `k` (from 1), 2^-32 tick. It is 0 for
    /// `k` 0.
    pub(crate) fn span(&self, k: u32) -> i128 {
        let Ticks { whole, frac } = self.first();
        let all = u64::from(k);
        let even = (times(whole.cast_signed(), k) << 32) + i128::from(u64::from(frac) * all);
        // k (k - 1) / 2 has 63 bits at most.
        let bends = all * all.saturating_sub(1) / 2;
        let (high, low) = ((bends >> 32) as u32, bends as u32);
        let low = even + times(self.add, low);
        if high == 0 { low } else { low + (times(self.add, high) << 32) }
    }

    /// Counts the steps, of the first `limit`, that are due within `elapsed` after the step before the
    /// segment. The time `elapsed` is in 2^-32 tick.
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

/// A segment that is [valid](Segment::is_valid). [`Segment::validated`] makes it outside the critical section in which
/// the executor takes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ValidSegment(Segment);

impl ValidSegment {
    /// Returns the segment.
    pub fn segment(&self) -> &Segment {
        &self.0
    }
}

/// Returns a product of 96 bits, by two of 64 bits. A processor of 32 bits takes three times as long for one of 128.
fn times(a: i64, b: u32) -> i128 {
    let (high, low) = ((a >> 32) * i64::from(b), (a as u64 & 0xffff_ffff) * u64::from(b));
    (i128::from(high) << 32) + i128::from(low)
}

/// The intervals of a segment in whole ticks. [`Segment::intervals`] makes them.
#[derive(Debug)]
pub struct Intervals<'a> {
    interval: Ticks,
    add: i64,
    left: u32,
    carry: &'a mut u32,
}

impl<'a> Intervals<'a> {
    pub(in crate::step) fn new(segment: &Segment, carry: &'a mut u32) -> Self {
        Self { interval: segment.first(), add: segment.add, left: segment.steps(), carry }
    }
}

impl Iterator for Intervals<'_> {
    type Item = u64;

    fn next(&mut self) -> Option<u64> {
        self.left = self.left.checked_sub(1)?;
        let Ticks { whole, frac } = self.interval.plus(Ticks { whole: 0, frac: *self.carry });
        *self.carry = frac;
        self.interval = self.interval.plus_fixed(self.add);
        Some(whole)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = usize::try_from(self.left).unwrap_or(usize::MAX);
        (left, Some(left))
    }
}

#[cfg(test)]
mod tests {
    use super::{Segment, times};

    #[test]
    fn a_span_is_the_sum_of_its_intervals() {
        for (interval, frac, add) in
            [(1000, 0, 0), (1000, 1, -(1 << 31)), ((1 << 48) - 1, u32::MAX, 1 << 40), (77, 5, i64::MAX >> 9)]
        {
            let segment = Segment { count: 1, interval, add, frac };
            let (mut sum, mut before) = (0, segment.interval_of(1));
            for k in 0..1000 {
                assert_eq!(segment.span(k), sum, "{segment:?} {k}");
                sum += before;
                before += i128::from(add);
            }
            // Gauss's sum, where adding up takes too long.
            for k in [65_536, 65_537, 92_682, 92_683, 1 << 31, u32::MAX] {
                let n = i128::from(k);
                let first = (i128::from(interval) << 32) + i128::from(frac);
                assert_eq!(
                    segment.span(k),
                    n * first + i128::from(add) * (n * (n - 1) / 2),
                    "{segment:?} {k}"
                );
            }
        }
    }

    #[test]
    fn a_product_of_96_bits_is_that_of_128() {
        let edges =
            [i64::MIN, i64::MIN + 1, -(1 << 32) - 1, -(1 << 32), -1, 0, 1, (1 << 32) - 1, 1 << 32, i64::MAX];
        for a in edges {
            for b in [0, 1, 2, 1000, u32::MAX - 1, u32::MAX] {
                assert_eq!(times(a, b), i128::from(a) * i128::from(b), "{a} {b}");
            }
        }
    }
}
