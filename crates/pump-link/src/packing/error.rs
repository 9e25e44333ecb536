//! Segments that cannot be packed, and bytes that are no segments.

use thiserror::Error;

/// The refusal to pack or unpack a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PackError {
    /// The bytes have no room for another segment.
    #[error("the bytes have no room for another segment")]
    Full,
    /// The segment was not rounded to the grain.
    #[error("the segment was not rounded to the grain; give it to the rounder first")]
    Grain,
    /// The bytes are no segment that can be made.
    #[error("the bytes are no segment that can be made")]
    Bytes,
    /// The segment cannot be made, or not once it is rounded to the grain.
    #[error("the segment has no steps, or an interval below 1 tick or above 2^48 ticks")]
    Segment,
}
