//! The brake: the way to rest from any speed, as a table of integers.

use super::segment::Segment;
use super::ticks::Ticks;

/// Largest number of entries of a [`Brake`].
pub const BRAKE_ENTRIES: usize = 32;

/// The way from rest to the fastest speed, which a stop walks backwards.
///
/// A stop takes its intervals from this table at any speed, without a root or a division for each step.
/// [`crate::plan::Motor::brake`] makes the brake of a motor.
///
/// ```
/// use pump_ctl::step::{Brake, Segment};
///
/// // Ten steps from rest, each interval 500 ticks shorter than the last, at 2^32 fractions a tick.
/// let climb = Segment { count: 10, interval: 6000, add: -500 * (1 << 32), frac: 0 };
/// let brake = Brake::from_climb([climb]).unwrap();
/// assert_eq!(brake.climb().count(), 1);
/// // A brake speeds up from rest: growing intervals make none.
/// assert_eq!(Brake::from_climb([Segment { add: 500, ..climb }]), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "[Segment; BRAKE_ENTRIES]", into = "[Segment; BRAKE_ENTRIES]")
)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Brake {
    /// Segments that speed up: counts are positive, intervals fall. Unused entries have count 0.
    climb: [Segment; BRAKE_ENTRIES],
}

impl From<Brake> for [Segment; BRAKE_ENTRIES] {
    fn from(brake: Brake) -> Self {
        brake.climb
    }
}

impl TryFrom<[Segment; BRAKE_ENTRIES]> for Brake {
    type Error = &'static str;

    /// Makes a brake with [`Brake::from_climb`] from the segments that have steps.
    fn try_from(climb: [Segment; BRAKE_ENTRIES]) -> Result<Self, Self::Error> {
        Self::from_climb(climb.into_iter().filter(|segment| segment.count != 0))
            .ok_or("a brake's segments must speed up from rest, with valid intervals")
    }
}

/// The remainder of a way down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Descent {
    /// Number of entries still to be walked, the last of them first.
    entries: usize,
    /// Steps of the entry that is walked first.
    steps: u32,
}

impl Brake {
    /// Makes a brake from segments that speed up from rest. Counts must be positive, and no interval may be
    /// longer than the one before.
    ///
    /// Other segments, or more than [`BRAKE_ENTRIES`] of them, give `None`.
    pub fn from_climb(segments: impl IntoIterator<Item = Segment>) -> Option<Self> {
        let mut climb = [Segment::default(); BRAKE_ENTRIES];
        let mut last = i128::MAX;
        let mut slots = climb.iter_mut();
        for segment in segments {
            let falls = segment.count > 0 && segment.add <= 0 && segment.interval_of(1) <= last;
            if !(falls && segment.is_valid()) {
                return None;
            }
            last = segment.interval_of(segment.steps());
            *slots.next()? = segment;
        }
        Some(Self { climb })
    }

    /// Makes a brake from entries that are known to speed up, up to the first with an interval below a tick.
    pub(crate) fn climbing(mut entry: impl FnMut(usize) -> Segment) -> Self {
        let mut climb = [Segment::default(); BRAKE_ENTRIES];
        for (n, slot) in climb.iter_mut().enumerate() {
            let segment = entry(n);
            if !segment.is_valid() {
                break;
            }
            *slot = segment;
        }
        Self { climb }
    }

    /// Returns the entries in use, in the order of speeding up.
    pub fn climb(&self) -> impl DoubleEndedIterator<Item = &Segment> {
        self.climb.iter().filter(|segment| segment.count != 0)
    }

    /// Returns the way down for a motor whose last interval was `interval`, 2^-32 tick. The first interval of
    /// the way down is no shorter. The result is `None` if the motor is so slow that it can stand at once.
    pub(super) fn descent_from(&self, interval: i128) -> Option<Descent> {
        let entries = self.climb().take_while(|segment| segment.interval_of(1) >= interval).count();
        let top = self.climb.get(entries.checked_sub(1)?)?;
        let shorter = u64::try_from(top.interval_of(1) - interval).unwrap_or(u64::MAX);
        // Number of the step after which the entry's interval would fall below `interval`.
        let below = shorter.checked_div(top.add.unsigned_abs()).unwrap_or(u64::MAX);
        let steps = u32::try_from(below).unwrap_or(u32::MAX).saturating_add(1).min(top.steps());
        Some(Descent { entries, steps })
    }

    /// Returns the steps of a way down and its time, 2^-32 tick.
    pub(super) fn length(&self, mut descent: Descent) -> (u32, i128) {
        let (mut steps, mut span) = (0_u32, 0);
        while let Some(segment) = self.next_down(&mut descent) {
            steps = steps.saturating_add(segment.steps());
            span += segment.span(segment.steps());
        }
        (steps, span)
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
