//! Segments as differences from the segment before.

use pump_ctl::step::Segment;

use super::error::PackError;
use super::grain::Grain;
use super::varint;

/// Largest number of bytes that a segment of a plan takes.
pub const MAX_PACKED_SEGMENT: usize = 5 + 13 + 10;

/// A machine that writes and reads segments one after another.
///
/// The first segment of a codec is written in full, so a new codec begins each frame and a frame can be read alone.
///
/// ```
/// use pump_ctl::step::Segment;
/// use pump_link::packing::{Codec, Grain, Rounder};
///
/// let mut rounder = Rounder::default();
/// let plan = [Segment { count: 40, interval: 990, add: 1 << 28, frac: 0 }; 2];
/// let plan = [plan[0], Segment { interval: 992, frac: 1 << 31, ..plan[1] }];
/// let sent = [rounder.round(plan[0])?, rounder.round(plan[1])?];
/// let mut bytes = [0; 32];
/// let mut room = &mut bytes[..];
/// let mut codec = Codec::new(Grain::Fine);
/// sent.iter().try_for_each(|segment| codec.write(segment, &mut room))?;
/// let len = 32 - room.len();
/// assert_eq!(len, 9);
///
/// let (mut codec, mut rest) = (Codec::new(Grain::Fine), &bytes[..len]);
/// assert_eq!([codec.read(&mut rest)?, codec.read(&mut rest)?], sent);
/// assert!(rest.is_empty());
/// # Ok::<(), pump_link::packing::PackError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Codec {
    grain: Grain,
    /// First interval of the next segment if it goes on evenly, 2^-32 tick.
    interval: i128,
    /// Change of the interval from step to step of the segment before, 2^-32 tick.
    add: i64,
}

impl Codec {
    /// Makes a codec before its first segment.
    pub const fn new(grain: Grain) -> Self {
        Self { grain, interval: 0, add: 0 }
    }

    /// Writes a segment to the front of `to`, and leaves the rest of `to` there.
    ///
    /// # Errors
    ///
    /// Fails with [`PackError::Full`] if `to` is too short, with [`PackError::Segment`] if the segment is not valid,
    /// and with [`PackError::Grain`] if it was not rounded to the codec's grain. The codec and `to` then stay as they
    /// were.
    pub fn write(&mut self, segment: &Segment, to: &mut &mut [u8]) -> Result<(), PackError> {
        if !segment.is_valid() {
            return Err(PackError::Segment);
        }
        let steps = segment.steps();
        let (interval_bits, add_bits) = self.grain.zero_bits(steps);
        let interval = fixed(segment);
        let add = if steps > 1 { segment.add } else { 0 };
        if (interval >> interval_bits) << interval_bits != interval
            || (add >> add_bits) << add_bits != segment.add
        {
            return Err(PackError::Grain);
        }
        let mut packed = [0; 3 * varint::MAX_BYTES];
        let room = packed.len();
        let mut rest = &mut packed[..];
        varint::write(i128::from(segment.count), &mut rest)?;
        varint::write((interval >> interval_bits) - (self.interval >> interval_bits), &mut rest)?;
        if steps > 1 {
            varint::write(i128::from(add >> add_bits) - i128::from(self.add >> add_bits), &mut rest)?;
        }
        let used = room - rest.len();
        let packed = packed.get(..used).unwrap_or_default();
        if to.len() < used {
            return Err(PackError::Full);
        }
        let (front, others) = core::mem::take(to).split_at_mut_checked(used).ok_or(PackError::Full)?;
        front.copy_from_slice(packed);
        *to = others;
        self.follow(segment);
        Ok(())
    }

    /// Reads a segment from the front of `from`, and leaves the rest of `from` there. The segment is valid.
    ///
    /// # Errors
    ///
    /// Fails with [`PackError::Bytes`] if the bytes are no segment that can be made.
    pub fn read(&mut self, from: &mut &[u8]) -> Result<Segment, PackError> {
        let count = i32::try_from(varint::read(from)?).map_err(|_| PackError::Bytes)?;
        let steps = count.unsigned_abs();
        let (interval_bits, add_bits) = self.grain.zero_bits(steps);
        let interval = restored(self.interval, varint::read(from)?, interval_bits)?;
        let add = if steps > 1 { restored(self.add.into(), varint::read(from)?, add_bits)? } else { 0 };
        let segment = Segment {
            count,
            interval: u64::try_from(interval >> 32).map_err(|_| PackError::Bytes)?,
            frac: interval as u32,
            add: i64::try_from(add).map_err(|_| PackError::Bytes)?,
        };
        if !segment.is_valid() {
            return Err(PackError::Bytes);
        }
        self.follow(&segment);
        Ok(segment)
    }

    /// Predicts the segment that follows.
    fn follow(&mut self, segment: &Segment) {
        self.interval = fixed(segment) + i128::from(segment.add) * i128::from(segment.steps());
        if segment.steps() > 1 {
            self.add = segment.add;
        }
    }
}

/// Returns the first interval of a segment, 2^-32 tick.
fn fixed(segment: &Segment) -> i128 {
    (i128::from(segment.interval) << 32) | i128::from(segment.frac)
}

/// Returns the value that is `units` of `1 << bits` above a prediction.
fn restored(predicted: i128, units: i128, bits: u32) -> Result<i128, PackError> {
    let units = (predicted >> bits).checked_add(units).ok_or(PackError::Bytes)?;
    units.checked_mul(1 << bits).ok_or(PackError::Bytes)
}
