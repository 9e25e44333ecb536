//! The queue: segments to come, the segment under way, and segments done, in one ring.

use super::segment::Segment;
use super::ticks::Ticks;

/// A segment, with the time and the position at which it began.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Slot {
    pub(super) segment: Segment,
    /// Time at which the step before the segment was due.
    pub(super) began: Ticks,
    /// Position at the time `began`, signed steps.
    pub(super) from: i64,
}

impl Slot {
    const EMPTY: Self =
        Self { segment: Segment { count: 0, interval: 0, add: 0, frac: 0 }, began: Ticks::ZERO, from: 0 };

    /// Returns the position after `k` steps of the segment.
    pub(super) fn position_after(&self, k: u32) -> i64 {
        self.from.wrapping_add(i64::from(self.segment.direction().sign()) * i64::from(k))
    }

    /// Returns the time at which step `k` (from 1) is due.
    pub(super) fn due(&self, k: u32) -> Ticks {
        Ticks::of_fixed(self.began.fixed() + self.segment.span(k))
    }
}

/// A ring of `Q` segments. A segment that is done stays until its place is needed.
// The slots come last, for the reason that is given at [`super::Stepper`].
#[derive(Debug, Clone)]
#[repr(C)]
pub(super) struct Queue<const Q: usize> {
    /// Place of the oldest segment.
    oldest: usize,
    /// Number of segments taken, the segment under way included.
    taken: usize,
    /// Number of segments to come.
    pending: usize,
    slots: [Slot; Q],
}

impl<const Q: usize> Queue<Q> {
    pub(super) fn new() -> Self {
        const { assert!(Q >= 2, "a queue needs room for the segment under way and one to come") };
        // A constant: the compiler clears the ring in its place. It copies a ring that a loop has filled.
        Self { slots: const { [Slot::EMPTY; Q] }, oldest: 0, taken: 0, pending: 0 }
    }

    /// Returns the place of the `n`-th segment, counted from the oldest. `n` is below `Q`.
    fn place(&self, n: usize) -> usize {
        let place = self.oldest + n;
        if place >= Q { place - Q } else { place }
    }

    /// Returns the number of segments to come.
    pub(super) fn len(&self) -> usize {
        self.pending
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pending == 0
    }

    /// Appends a segment. In a full ring the oldest segment that is done gives way. Fewer than `Q` segments
    /// must be to come.
    pub(super) fn push(&mut self, segment: Segment) {
        if self.taken + self.pending == Q {
            self.oldest = self.place(1);
            self.taken = self.taken.saturating_sub(1);
        }
        let place = self.place(self.taken + self.pending);
        if let Some(slot) = self.slots.get_mut(place) {
            slot.segment = segment;
        }
        self.pending += 1;
    }

    /// Takes the next segment, which begins at the time `began` and the position `from`.
    pub(super) fn take(&mut self, began: Ticks, from: i64) -> Option<Segment> {
        self.pending = self.pending.checked_sub(1)?;
        let place = self.place(self.taken);
        self.taken += 1;
        let slot = self.slots.get_mut(place)?;
        slot.began = began;
        slot.from = from;
        Some(slot.segment)
    }

    /// Drops the segments to come, except the first `keep`.
    pub(super) fn keep_pending(&mut self, keep: usize) {
        self.pending = self.pending.min(keep);
    }

    /// Shortens the last segment to `steps`. It is the segment under way if none is to come.
    pub(super) fn cut(&mut self, steps: u32) {
        let last = self.place((self.taken + self.pending).saturating_sub(1));
        if let Some(slot) = self.slots.get_mut(last) {
            let steps = i32::try_from(steps).unwrap_or(i32::MAX);
            slot.segment.count = steps * i32::from(slot.segment.direction().sign());
        }
    }

    /// Splits the segment under way after `made` steps. `rest` is then the next segment to come. The oldest
    /// segment gives way if there is no place. At worst that is the segment under way.
    pub(super) fn split(&mut self, made: u32, rest: Segment) {
        let to_come = core::mem::take(&mut self.pending);
        self.cut(made);
        self.pending = to_come;
        let mut carried = rest;
        for n in self.taken..self.taken + to_come {
            let place = self.place(n);
            if let Some(slot) = self.slots.get_mut(place) {
                core::mem::swap(&mut slot.segment, &mut carried);
            }
        }
        self.push(carried);
    }

    /// Forgets all segments.
    pub(super) fn clear(&mut self) {
        (self.oldest, self.taken, self.pending) = (0, 0, 0);
    }

    /// Returns the segment under way, or the last segment taken.
    pub(super) fn current(&self) -> Option<&Slot> {
        self.slots.get(self.place(self.taken.checked_sub(1)?))
    }

    /// Returns the segments taken, newest first.
    pub(super) fn taken(&self) -> impl Iterator<Item = &Slot> {
        (0..self.taken).rev().filter_map(|n| self.slots.get(self.place(n)))
    }

    /// Returns the segments to come, in order.
    pub(super) fn pending(&self) -> impl Iterator<Item = &Segment> {
        (self.taken..self.taken + self.pending)
            .filter_map(|n| self.slots.get(self.place(n)))
            .map(|slot| &slot.segment)
    }
}
