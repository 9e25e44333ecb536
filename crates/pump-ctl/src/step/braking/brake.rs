//! The brake: the way to rest from any speed, as a table of integers.

use super::error::BrakeError;
use crate::step::direction::Direction;
use crate::step::segment::{MAX_INTERVAL, Segment};
use crate::step::tick_rate::TickRate;
use crate::step::ticks::Ticks;

/// Largest number of entries of a [`Brake`].
pub const BRAKE_ENTRIES: usize = 32;

/// The way from rest to the fastest speed, which a stop walks backwards.
///
/// A stop takes its intervals from this table at any speed, without a root or a division for each step.
/// [`crate::plan::Motor::brake`] makes the brake of a motor. A brake has at least one entry: without any, a
/// stop would be a dead stop from full speed.
///
/// ```
/// use pump_ctl::step::{Brake, BrakeError, Segment, TickRate};
///
/// const TICK_RATE: TickRate = TickRate::from_hz(1_000_000).unwrap();
/// // Ten steps from rest, each interval 500 ticks shorter than the last, at 2^32 fractions a tick.
/// let climb = Segment { count: 10, interval: 6000, add: -500 * (1 << 32), frac: 0 };
/// let brake = Brake::from_climb(TICK_RATE, [climb])?;
/// assert_eq!((brake.climb().count(), brake.tick_rate()), (1, TICK_RATE));
/// // A brake speeds up from rest: growing intervals make none, and neither does nothing.
/// let slower = Segment { add: 500, ..climb };
/// let refused = Brake::from_climb(TICK_RATE, [slower]);
/// assert_eq!(refused, Err(BrakeError::Segment { number: 1, segment: slower }));
/// assert_eq!(Brake::from_climb(TICK_RATE, []), Err(BrakeError::Empty));
/// # Ok::<(), BrakeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredBrake", into = "StoredBrake"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Brake {
    /// Rate of the timer that the segments are made for.
    tick_rate: TickRate,
    /// Segments that speed up: counts are positive, intervals fall. Unused entries have count 0 and stand at
    /// the end. There is one entry in use at least.
    climb: [Segment; BRAKE_ENTRIES],
    /// Steps and time of the entries below each entry. A stop in an interrupt has no time to add them up.
    below: [Below; BRAKE_ENTRIES],
}

/// The steps and the time of the entries below one. Whole ticks and fraction stand side by side, to save a third.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Below {
    whole: u64,
    frac: u32,
    steps: u32,
}

/// A brake as it is stored. Unused entries are zero and stand at the end.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
struct StoredBrake {
    tick_rate: TickRate,
    climb: [Segment; BRAKE_ENTRIES],
}

#[cfg(feature = "serde")]
impl From<Brake> for StoredBrake {
    fn from(Brake { tick_rate, climb, .. }: Brake) -> Self {
        Self { tick_rate, climb }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<StoredBrake> for Brake {
    type Error = BrakeError;

    fn try_from(StoredBrake { tick_rate, climb }: StoredBrake) -> Result<Self, BrakeError> {
        let used =
            climb.iter().rposition(|segment| *segment != Segment::default()).map_or(0, |last| last + 1);
        Self::from_climb(tick_rate, climb.into_iter().take(used))
    }
}

/// The remainder of a way down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::step) struct Descent {
    /// Number of entries still to be walked, the last of them first.
    entries: usize,
    /// Steps of the entry that is walked first.
    steps: u32,
}

impl Brake {
    /// Makes a brake from segments that speed up from rest, for a timer of this rate.
    ///
    /// # Errors
    ///
    /// Fails with [`BrakeError::Empty`] if there is no segment, and with [`BrakeError::TooMany`] if there are
    /// more than [`BRAKE_ENTRIES`]. Fails with [`BrakeError::Segment`] if a segment is not valid, does not go
    /// forward, or has an interval that is longer than the one before.
    pub fn from_climb(
        tick_rate: TickRate,
        segments: impl IntoIterator<Item = Segment>,
    ) -> Result<Self, BrakeError> {
        let mut climb = [Segment::default(); BRAKE_ENTRIES];
        let mut last = i128::MAX;
        let mut number = 0;
        let mut slots = climb.iter_mut();
        for segment in segments {
            number += 1;
            let Some(slot) = slots.next() else {
                return Err(BrakeError::TooMany);
            };
            let falls = segment.count > 0 && segment.add <= 0 && segment.interval_of(1) <= last;
            if !(falls && segment.is_valid()) {
                return Err(BrakeError::Segment { number, segment });
            }
            last = segment.interval_of(segment.steps());
            *slot = segment;
        }
        if number == 0 { Err(BrakeError::Empty) } else { Ok(Self::of(tick_rate, climb)) }
    }

    /// Makes a brake for a motor that is not to move yet, until its own is known
    /// ([`crate::step::Stepper::set_brake`]).
    pub fn standing(tick_rate: TickRate) -> Self {
        let mut climb = [Segment::default(); BRAKE_ENTRIES];
        if let Some(first) = climb.first_mut() {
            *first = Segment { count: 1, interval: MAX_INTERVAL, add: 0, frac: 0 };
        }
        Self::of(tick_rate, climb)
    }

    /// Makes the brake of entries that were checked.
    fn of(tick_rate: TickRate, climb: [Segment; BRAKE_ENTRIES]) -> Self {
        let mut below = [Below::default(); BRAKE_ENTRIES];
        let mut sum = Below::default();
        for (segment, below) in climb.iter().zip(&mut below) {
            *below = sum;
            sum = sum.and(segment, segment.steps());
        }
        Self { tick_rate, climb, below }
    }

    /// Makes a brake from entries that are known to speed up, up to the first with an interval below a tick.
    pub(crate) fn climbing(
        tick_rate: TickRate,
        mut entry: impl FnMut(usize) -> Segment,
    ) -> Result<Self, BrakeError> {
        let mut climb = [Segment::default(); BRAKE_ENTRIES];
        for (n, slot) in climb.iter_mut().enumerate() {
            let segment = entry(n);
            if !segment.is_valid() {
                if n == 0 {
                    return Err(BrakeError::SlowTimer { tick_rate });
                }
                break;
            }
            *slot = segment;
        }
        Ok(Self::of(tick_rate, climb))
    }

    /// Returns the rate of the timer that the brake is made for.
    pub fn tick_rate(&self) -> TickRate {
        self.tick_rate
    }

    /// Returns the entries in use, in the order of speeding up.
    pub fn climb(&self) -> impl DoubleEndedIterator<Item = &Segment> {
        self.climb.iter().filter(|segment| segment.count != 0)
    }

    /// Returns the segments by which a motor that turns in `direction` comes to rest. The interval before its
    /// last step was `interval`.
    ///
    /// Use them where steps come from hardware, and not from [`crate::step::Stepper`], which stops by itself. There
    /// are none if the motor is so slow that it can stand at once.
    ///
    /// ```
    /// use pump_ctl::plan::Motor;
    /// use pump_ctl::step::{Direction, TickRate, Ticks};
    ///
    /// let motor = Motor::new(12_800.0, 17.8, 500.0);
    /// let brake = motor.brake(TickRate::from_hz(1_000_000).unwrap())?;
    /// // 2,000 steps a second.
    /// let way = || brake.descent(Ticks { whole: 500, frac: 0 }, Direction::Reverse);
    /// assert_eq!(way().map(|segment| segment.count).sum::<i32>(), -2);
    /// assert!(way().all(|segment| segment.interval >= 500 && segment.add >= 0));
    /// # Ok::<(), pump_ctl::step::BrakeError>(())
    /// ```
    pub fn descent(&self, interval: Ticks, direction: Direction) -> impl Iterator<Item = Segment> + '_ {
        let mut descent = self.descent_from(interval.fixed());
        core::iter::from_fn(move || {
            let mut segment = self.next_down(descent.as_mut()?)?;
            segment.count *= i32::from(direction.sign());
            Some(segment)
        })
    }

    /// Returns the way down for a motor whose last interval was `interval`, 2^-32 tick. The first interval of
    /// the way down is no shorter. The result is `None` if the motor is so slow that it can stand at once.
    pub(in crate::step) fn descent_from(&self, interval: i128) -> Option<Descent> {
        let last = Ticks::of_fixed(interval);
        let entries = self.climb().take_while(|segment| segment.first() >= last).count();
        let top = self.climb.get(entries.checked_sub(1)?)?;
        let shorter = u64::try_from(top.interval_of(1) - interval).unwrap_or(u64::MAX);
        // Number of the step after which the entry's interval would fall below `interval`.
        let below = shorter.checked_div(top.add.unsigned_abs()).unwrap_or(u64::MAX);
        let steps = u32::try_from(below).unwrap_or(u32::MAX).saturating_add(1).min(top.steps());
        Some(Descent { entries, steps })
    }

    /// Returns the steps of a way down.
    pub(in crate::step) fn steps_down(&self, descent: &Descent) -> u32 {
        self.below(descent).map_or(0, |(below, _)| below.steps.saturating_add(descent.steps))
    }

    /// Returns the steps of a way down and its time, 2^-32 tick.
    pub(in crate::step) fn length(&self, descent: &Descent) -> (u32, i128) {
        let whole = self.below(descent).map(|(below, entry)| below.and(entry, descent.steps));
        whole.map_or((0, 0), |whole| (whole.steps, whole.span().fixed()))
    }

    /// Returns the entry that a way down walks first, and those below it.
    fn below(&self, descent: &Descent) -> Option<(Below, &Segment)> {
        let entry = descent.entries.checked_sub(1)?;
        Some((*self.below.get(entry)?, self.climb.get(entry)?))
    }

    /// Returns the next segment of a way down. It slows down and has a positive count.
    pub(super) fn next_down(&self, descent: &mut Descent) -> Option<Segment> {
        let below = descent.entries.checked_sub(1)?;
        let up = self.climb.get(below)?;
        let fastest = Ticks::of_fixed(up.interval_of(descent.steps));
        let down = Segment {
            count: i32::try_from(descent.steps).unwrap_or(i32::MAX),
            interval: fastest.whole,
            frac: fastest.frac,
            add: -up.add,
        };
        descent.entries = below;
        let next = below.checked_sub(1).and_then(|entry| self.climb.get(entry));
        descent.steps = next.map_or(0, Segment::steps);
        Some(down)
    }
}

impl Below {
    /// Returns the sum with the first `steps` steps of a segment.
    fn and(self, segment: &Segment, steps: u32) -> Self {
        let Ticks { whole, frac } = Ticks::of_fixed(self.span().fixed() + segment.span(steps));
        Self { whole, frac, steps: self.steps.saturating_add(steps) }
    }

    fn span(self) -> Ticks {
        Ticks { whole: self.whole, frac: self.frac }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_down_is_as_long_as_its_segments() {
        let motor = crate::plan::Motor::new(12_800.0, 17.8, 500.0);
        for hz in [1_000, 1_000_000, 125_000_000] {
            let brake = motor.brake(TickRate::from_hz(hz).unwrap()).unwrap();
            for interval in (1..60).map(|n| (1_i128 << 32) * i128::from(hz) / (50 * n * n)) {
                let Some(descent) = brake.descent_from(interval) else { continue };
                let (mut way, mut steps, mut span) = (descent, 0, 0);
                while let Some(segment) = brake.next_down(&mut way) {
                    steps += segment.steps();
                    span += segment.span(segment.steps());
                }
                assert_eq!(brake.length(&descent), (steps, span), "{hz} {interval}");
                assert_eq!(brake.steps_down(&descent), steps);
            }
        }
    }
}
