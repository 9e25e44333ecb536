//! Frames that are refused.

use thiserror::Error;

/// The refusal of a frame. Nothing was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FrameError {
    /// The bytes between two zeros are no frame: too few, too many, or not in COBS.
    #[error("the bytes are no frame; check the speed of the serial line and what is connected to it")]
    Shape,
    /// The checksum does not fit.
    #[error("the frame's checksum does not fit; the serial line corrupts bytes")]
    Checksum,
    /// The frame is of another version of the protocol.
    #[error(
        "the frame has version {version} of the protocol, and {} is known; update the older of program and board",
        super::VERSION
    )]
    Version {
        /// Version that the frame names.
        version: u8,
    },
    /// The checksum fits, and the body is no message.
    #[error("the frame's body is no message of this version")]
    Body,
    /// The message is longer than a frame can hold.
    #[error("the message is longer than the {} bytes of a frame", super::MAX_PAYLOAD)]
    TooLong,
}
