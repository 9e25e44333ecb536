//! The header of a frame, at the same place in every version of the protocol.

use super::VERSION;
use super::error::FrameError;

/// The header of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RequestHeader {
    /// Number of the request, which its answer repeats.
    pub number: u16,
    /// Session number that the host holds.
    pub session: u64,
}

/// The header of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AnswerHeader {
    /// Number of the request that is answered.
    pub number: u16,
    /// Session number that the node holds. It is 0 after a reset.
    pub session: u64,
    /// Tick of the node's timer at which the request's last byte was taken.
    pub received_at: u64,
}

impl RequestHeader {
    /// Bytes of the header.
    pub const BYTES: usize = 11;

    /// Returns the header as it crosses the line.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut bytes = [VERSION; Self::BYTES];
        let (number, session) = (self.number.to_le_bytes(), self.session.to_le_bytes());
        bytes.iter_mut().skip(1).zip(number.into_iter().chain(session)).for_each(|(to, from)| *to = from);
        bytes
    }

    /// Splits a payload into its header and its body.
    ///
    /// # Errors
    ///
    /// Fails with [`FrameError::Shape`] if the payload is shorter than a header, and with [`FrameError::Version`]
    /// if it is of another version. [`Self::of_any_version`] then has its number.
    pub fn split(payload: &[u8]) -> Result<(Self, &[u8]), FrameError> {
        let header = Self::of_any_version(payload).ok_or(FrameError::Shape)?;
        known(payload)?;
        Ok((header, payload.get(Self::BYTES..).unwrap_or_default()))
    }

    /// Returns the header of a payload of any version, or `None` if the payload is too short.
    pub fn of_any_version(payload: &[u8]) -> Option<Self> {
        let (_, rest) = payload.split_first()?;
        let (number, rest) = rest.split_first_chunk()?;
        let (session, _) = rest.split_first_chunk()?;
        Some(Self { number: u16::from_le_bytes(*number), session: u64::from_le_bytes(*session) })
    }
}

impl AnswerHeader {
    /// Bytes of the header.
    pub const BYTES: usize = 19;

    /// Returns the header as it crosses the line.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        let common = RequestHeader { number: self.number, session: self.session }.to_bytes();
        let all = common.into_iter().chain(self.received_at.to_le_bytes());
        bytes.iter_mut().zip(all).for_each(|(to, from)| *to = from);
        bytes
    }

    /// Splits a payload into its header and its body.
    ///
    /// # Errors
    ///
    /// Fails with [`FrameError::Version`] if the payload is of another version, and with [`FrameError::Shape`] if
    /// it is shorter than a header.
    pub fn split(payload: &[u8]) -> Result<(Self, &[u8]), FrameError> {
        known(payload)?;
        let common = RequestHeader::of_any_version(payload).ok_or(FrameError::Shape)?;
        let rest = payload.get(RequestHeader::BYTES..).unwrap_or_default();
        let (received_at, body) = rest.split_first_chunk().ok_or(FrameError::Shape)?;
        let received_at = u64::from_le_bytes(*received_at);
        Ok((Self { number: common.number, session: common.session, received_at }, body))
    }
}

fn known(payload: &[u8]) -> Result<(), FrameError> {
    match payload.first() {
        Some(&VERSION) => Ok(()),
        Some(&version) => Err(FrameError::Version { version }),
        None => Err(FrameError::Shape),
    }
}
