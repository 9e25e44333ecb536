//! The ramp to the end of a plan, where the brake would lead beyond.

use crate::step::segment::Segment;
use crate::step::ticks::Ticks;

/// The way to rest in a given number of steps, at an even deceleration.
///
/// At an even deceleration a the speed j steps of s rad before the rest is sqrt(2 a s j). The time from there to the
/// rest is then t(j) = T sqrt(j), with T = sqrt(2 s / a): the motion of Galilei's inclined plane. The last interval
/// of the plan gives T, because it is t(d + 1) - t(d) where d steps are left. A plan that comes to rest at an even
/// deceleration is followed to the tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::step) struct FinalRamp {
    /// Steps left.
    left: u32,
    /// Time of the last step T, 2^-16 tick.
    last: u64,
    /// Time from here to the rest.
    remaining: Ticks,
}

/// Binary logarithm of the number of segments in which the steps left would be made at least. Intervals grow evenly
/// in a segment. With 64 the deceleration is 1.2 % above the even one at most.
const PARTS_LOG2: u32 = 6;

/// Fraction bits of the time [`FinalRamp::last`].
const LAST_BITS: u32 = 16;

impl FinalRamp {
    /// Makes the way to rest in `left` steps for a motor whose last interval was `interval`, 2^-32 tick.
    pub(super) fn new(interval: i128, left: u32) -> Self {
        let of = |steps| {
            let root = Root::of(steps);
            (interval.unsigned_abs() * u128::from(root.digits)) >> (root.bits + 32 - LAST_BITS)
        };
        // (t(d + 1) - t(d)) (sqrt(d + 1) + sqrt(d)) = T.
        let last = of(left) + of(left.saturating_add(1));
        let mut ramp = Self { left, last: u64::try_from(last).unwrap_or(u64::MAX), remaining: Ticks::ZERO };
        ramp.remaining = Ticks::of_fixed(ramp.time(left));
        ramp
    }

    /// Returns the steps that are left and their time, 2^-32 tick.
    pub(super) fn length(&self) -> (u32, i128) {
        (self.left, self.remaining.fixed())
    }

    /// Returns the next segment of the way. It slows down and has a positive count. The last one ends to the fraction
    /// when [`Self::length`] said.
    pub(super) fn next_down(&mut self) -> Option<Segment> {
        let scale = self.left.checked_ilog2()?;
        let log2 = scale.saturating_sub(PARTS_LOG2);
        let count = 1 << log2;
        let left = self.left - count;
        let mean = (self.remaining.fixed() - self.time(left)).max(0) >> log2;
        // Intervals are as 1 / sqrt(j): each is longer than the last by 1 / (2 j) of it, in the middle of the segment.
        let middle = i128::from(self.left) + i128::from(left);
        let add = if count == 1 { 0 } else { mean.checked_div(middle).unwrap_or(0) };
        let add = i64::try_from(add).unwrap_or(i64::MAX);
        let first = Ticks::of_fixed((mean - ((i128::from(add) * i128::from(count - 1)) >> 1)).max(0));
        let segment = Segment {
            count: i32::try_from(count).unwrap_or(i32::MAX),
            interval: first.whole,
            frac: first.frac,
            add,
        };
        self.left = left;
        self.remaining = Ticks::of_fixed((self.remaining.fixed() - segment.span(count)).max(0));
        Some(segment)
    }

    /// Returns the time to the rest where `left` steps are left, 2^-32 tick.
    fn time(&self, left: u32) -> i128 {
        let root = Root::of(left);
        ((u128::from(self.last) * u128::from(root.digits)) >> (root.bits + LAST_BITS - 32)).cast_signed()
    }
}

/// The square root of a whole number, to 32 bits.
struct Root {
    /// Digits of the root. The root is digits / 2^bits.
    digits: u64,
    /// Number of digits behind the binary point, 16 at least.
    bits: u32,
}

impl Root {
    fn of(number: u32) -> Self {
        let number = u64::from(number);
        let shift = (number.leading_zeros() & !1).min(62);
        Self { digits: (number << shift).isqrt(), bits: shift / 2 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_takes_as_many_steps_and_as_long_as_it_says() {
        for left in [1, 2, 3, 63, 64, 65, 127, 128, 129, 1000, 70_000, 5_000_000] {
            for interval in [1_i128 << 32, 1000 << 32, (123_456 << 32) + 987, 1 << 62] {
                let mut ramp = FinalRamp::new(interval, left);
                let (steps, span) = ramp.length();
                // T sqrt(d), T from the interval before.
                let d = f64::from(left);
                let expected = interval as f64 * ((d + 1.0).sqrt() + d.sqrt()) * d.sqrt();
                assert!((span as f64 / expected - 1.0).abs() < 1e-4, "{left} {interval}: {span} {expected}");
                let (mut made, mut took, mut last) = (0, 0, interval);
                while let Some(segment) = ramp.next_down() {
                    made += segment.steps();
                    took += segment.span(segment.steps());
                    assert!(segment.add >= 0 && segment.count > 0);
                    // No interval is shorter than the one before, up to the segments' bend.
                    let first = segment.interval_of(1) as f64;
                    assert!(first > 0.999_9 * last as f64, "{left} {interval}: {first} after {last}");
                    last = segment.interval_of(segment.steps());
                }
                assert_eq!((made, took), (steps, span));
            }
        }
    }
}
