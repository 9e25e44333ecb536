//! The grain: how exactly intervals are written.

/// How exactly the intervals of segments are written.
///
/// A segment of n steps with a fine grain has its first interval in units of 2^-4 / n tick and the change of its
/// interval in units of 2^-1 / n² tick, n rounded up to a power of two. Half a unit of either moves no step by more
/// than a thirty-second part of a tick, because [`super::Rounder`] pins the segment's end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grain {
    /// Every segment crosses the link to its last bit.
    Exact,
    /// Segments of a plan, rounded by [`super::Rounder`].
    Fine,
}

impl Grain {
    /// Returns the bits of the first interval, and of its change from step to step, that are zero in a segment of
    /// `steps`. The last bit is worth 2^-32 tick.
    pub(super) fn zero_bits(self, steps: u32) -> (u32, u32) {
        match self {
            Self::Exact => (0, 0),
            Self::Fine => {
                let log2 = u32::BITS - steps.saturating_sub(1).leading_zeros();
                (28_u32.saturating_sub(log2), 31_u32.saturating_sub(2 * log2))
            }
        }
    }
}
