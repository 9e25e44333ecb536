//! A frame as it crosses the line.

use serde::{Deserialize, Serialize};

use super::error::FrameError;
use super::header::{AnswerHeader, RequestHeader};
use super::{CRC, CRC_BYTES, MAX_FRAME, MAX_PAYLOAD};
use crate::message::{Answer, Request};

/// A frame as it crosses the line, a zero at each end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Encoded {
    bytes: [u8; MAX_FRAME],
    len: usize,
}

impl Encoded {
    /// Makes the frame of a request.
    ///
    /// # Errors
    ///
    /// Fails with [`FrameError::TooLong`] if the request does not fit into a frame.
    pub fn request(header: RequestHeader, request: &Request<'_>) -> Result<Self, FrameError> {
        Self::of(&header.to_bytes(), request)
    }

    /// Makes the frame of an answer.
    ///
    /// # Errors
    ///
    /// Fails with [`FrameError::TooLong`] if the answer does not fit into a frame.
    pub fn answer(header: AnswerHeader, answer: &Answer) -> Result<Self, FrameError> {
        Self::of(&header.to_bytes(), answer)
    }

    /// Returns the bytes to send.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or_default()
    }

    fn of(header: &[u8], message: &impl Serialize) -> Result<Self, FrameError> {
        let mut plain = [0; MAX_PAYLOAD + CRC_BYTES];
        let (front, rest) = plain.split_at_mut_checked(header.len()).ok_or(FrameError::TooLong)?;
        front.copy_from_slice(header);
        let room = rest.get_mut(..MAX_PAYLOAD - header.len()).ok_or(FrameError::TooLong)?;
        let body = postcard::to_slice(message, room).map_err(|_| FrameError::TooLong)?.len();
        let payload = header.len() + body;
        let sum = CRC.checksum(plain.get(..payload).unwrap_or_default()).to_le_bytes();
        plain.iter_mut().skip(payload).zip(sum).for_each(|(to, from)| *to = from);
        let mut bytes = [0; MAX_FRAME];
        let within = bytes.get_mut(1..MAX_FRAME - 1).unwrap_or_default();
        let plain = plain.get(..payload + CRC_BYTES).unwrap_or_default();
        let coded = cobs::try_encode(plain, within).map_err(|_| FrameError::TooLong)?;
        Ok(Self { bytes, len: coded + 2 })
    }
}

/// Reads the message of a body.
///
/// # Errors
///
/// Fails with [`FrameError::Body`] if the body is no such message, or longer than one.
pub fn body<'a, M: Deserialize<'a>>(body: &'a [u8]) -> Result<M, FrameError> {
    match postcard::take_from_bytes(body) {
        Ok((message, [])) => Ok(message),
        _ => Err(FrameError::Body),
    }
}
