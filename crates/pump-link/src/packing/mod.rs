//! Segments in a few bytes each.
//!
//! A smooth flow needs up to 82 segments in 100 ms at 1 MHz. A [`Segment`] of `pump-ctl` has 24 bytes, and most of
//! them say what the segment before has said: the interval goes on where that one ended. [`Codec`] writes the
//! differences from such a prediction as variable-length integers, in units of a grain. Rounding to the grain is the
//! host's task alone: [`Rounder`] does it once, so that no step is off by more than a tenth of a tick and errors do
//! not add up. Both ends then have the same integers.
//!
//! [`Segment`]: pump_ctl::step::Segment

mod codec;
mod error;
mod grain;
mod rounder;
mod varint;

pub use codec::{Codec, MAX_PACKED_SEGMENT};
pub use error::PackError;
pub use grain::Grain;
pub use rounder::Rounder;
