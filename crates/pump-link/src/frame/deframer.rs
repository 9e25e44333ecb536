//! Frames out of a stream of bytes.

use super::error::FrameError;
use super::header::RequestHeader;
use super::{CRC, CRC_BYTES, MAX_FRAME};

/// Longest frame between its zeros, bytes.
const MAX_INSIDE: usize = MAX_FRAME - 2;

/// A machine that finds frames in a stream of bytes.
///
/// After any error the next frame is found again. Any bytes may be pushed.
///
/// ```
/// use pump_link::frame::{Deframer, FrameError};
///
/// let mut deframer = Deframer::new();
/// assert_eq!(deframer.push(0), None);
/// assert!([9, 9, 9].into_iter().all(|byte| deframer.push(byte).is_none()));
/// assert_eq!(deframer.push(0), Some(Err(FrameError::Shape)));
/// ```
#[derive(Debug, Clone)]
pub struct Deframer {
    bytes: [u8; MAX_INSIDE],
    /// Number of bytes since the last zero. It is larger than `MAX_INSIDE` if they are too many for a frame.
    len: usize,
}

impl Default for Deframer {
    fn default() -> Self {
        Self::new()
    }
}

impl Deframer {
    /// Makes a machine that has seen no byte.
    pub const fn new() -> Self {
        Self { bytes: [0; MAX_INSIDE], len: 0 }
    }

    /// Takes a byte. Returns a frame's header and body when the byte ends a frame. The result is an error if the
    /// bytes since the last zero are no frame.
    pub fn push(&mut self, byte: u8) -> Option<Result<&[u8], FrameError>> {
        if byte != 0 {
            if let Some(place) = self.bytes.get_mut(self.len) {
                *place = byte;
            }
            self.len = (self.len + 1).min(MAX_INSIDE + 1);
            return None;
        }
        match core::mem::take(&mut self.len) {
            0 => None,
            len => Some(self.payload(len)),
        }
    }

    fn payload(&mut self, len: usize) -> Result<&[u8], FrameError> {
        let coded = self.bytes.get_mut(..len).ok_or(FrameError::Shape)?;
        let plain = cobs::decode_in_place(coded).map_err(|_| FrameError::Shape)?;
        let plain = self.bytes.get(..plain).ok_or(FrameError::Shape)?;
        let (payload, sum) = plain.split_last_chunk::<CRC_BYTES>().ok_or(FrameError::Shape)?;
        if payload.len() < RequestHeader::BYTES {
            return Err(FrameError::Shape);
        }
        if CRC.checksum(payload) != u32::from_le_bytes(*sum) {
            return Err(FrameError::Checksum);
        }
        Ok(payload)
    }
}
