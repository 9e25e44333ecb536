//! Frames out of a stream of bytes.

use cobs::{DecodeResult, DecoderState};

use super::error::FrameError;
use super::header::RequestHeader;
use super::{CRC, CRC_BYTES, MAX_PAYLOAD};

/// Longest header, body and CRC, bytes.
const MAX_PLAIN: usize = MAX_PAYLOAD + CRC_BYTES;

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
#[derive(Debug)]
pub struct Deframer {
    plain: [u8; MAX_PLAIN],
    /// Number of bytes of `plain` since the last zero. It is larger than `MAX_PLAIN` if they are too many for a frame.
    len: usize,
    coding: DecoderState,
}

impl Default for Deframer {
    fn default() -> Self {
        Self::new()
    }
}

impl Deframer {
    /// Makes a machine that has seen no byte.
    pub const fn new() -> Self {
        Self { plain: [0; MAX_PLAIN], len: 0, coding: DecoderState::Idle }
    }

    /// Takes a byte. Returns a frame's header and body when the byte ends a frame. The result is an error if the
    /// bytes since the last zero are no frame.
    pub fn push(&mut self, byte: u8) -> Option<Result<&[u8], FrameError>> {
        match self.coding.feed(byte) {
            Ok(DecodeResult::NoData) => None,
            Ok(DecodeResult::DataStart) => {
                self.len = 0;
                None
            }
            Ok(DecodeResult::DataContinue(plain)) => {
                if let Some(place) = self.plain.get_mut(self.len) {
                    *place = plain;
                }
                self.len = (self.len + 1).min(MAX_PLAIN + 1);
                None
            }
            Ok(DecodeResult::DataComplete) => Some(self.payload()),
            Err(_) => Some(Err(FrameError::Shape)),
        }
    }

    fn payload(&self) -> Result<&[u8], FrameError> {
        let plain = self.plain.get(..self.len).ok_or(FrameError::Shape)?;
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
