//! Segments rounded to the grain of the link.

use pump_ctl::step::Segment;

use super::error::PackError;
use super::grain::Grain;

/// A machine that rounds the segments of a plan to [`Grain::Fine`], one after another.
///
/// The end of each segment stays within 1/32 tick of the plan's, because each segment makes up for what the ones
/// before have left. No step in between is off by more than a tenth of a tick.
#[derive(Debug, Clone, Default)]
pub struct Rounder {
    /// Delay of the last step behind the plan's, 2^-32 tick.
    late: i128,
}

impl Rounder {
    /// Rounds the next segment of the plan.
    ///
    /// # Errors
    ///
    /// Fails with [`PackError::Segment`] if the segment is not valid, or not once it is rounded. The rounder is
    /// unchanged then.
    pub fn round(&mut self, segment: Segment) -> Result<Segment, PackError> {
        if !segment.is_valid() {
            return Err(PackError::Segment);
        }
        let steps = segment.steps();
        let (interval_bits, add_bits) = Grain::Fine.zero_bits(steps);
        let add = if steps > 1 { nearest(segment.add.into(), add_bits) } else { 0 };
        let n = i128::from(steps);
        let bends = |add: i128| add * (n * (n - 1) / 2);
        let first = (i128::from(segment.interval) << 32) | i128::from(segment.frac);
        // The rounded segment ends when the plan's does.
        let due = n * first + bends(segment.add.into()) - self.late;
        let unit = n << interval_bits;
        let interval = (due - bends(add) + unit / 2).div_euclid(unit) << interval_bits;
        let rounded = Segment {
            count: segment.count,
            interval: u64::try_from(interval >> 32).map_err(|_| PackError::Segment)?,
            frac: interval as u32,
            add: i64::try_from(add).map_err(|_| PackError::Segment)?,
        };
        if !rounded.is_valid() {
            return Err(PackError::Segment);
        }
        self.late = n * interval + bends(add) - due;
        Ok(rounded)
    }
}

/// Returns the multiple of `1 << bits` that is nearest to `value`.
fn nearest(value: i128, bits: u32) -> i128 {
    let half = (1_i128 << bits) >> 1;
    ((value + half) >> bits) << bits
}
