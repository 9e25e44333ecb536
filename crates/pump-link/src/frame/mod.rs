//! Frames: how messages cross a serial line that loses and corrupts bytes.
//!
//! A frame is `0, COBS(header, body, CRC-32), 0`. COBS (Cheshire and Baker, IEEE/ACM Transactions on Networking 7,
//! 1999) leaves no zero inside, so a receiver finds the next frame after any error. The CRC is CRC-32/ISO-HDLC,
//! little end first. The header is fixed for all versions of the protocol; the body is a message in postcard.

mod deframer;
mod encoded;
mod error;
mod header;

pub use deframer::Deframer;
pub use encoded::{Encoded, body};
pub use error::FrameError;
pub use header::{AnswerHeader, RequestHeader};

/// Version of the protocol. It grows when the meaning of any byte changes.
pub const VERSION: u8 = 3;

/// Largest header and body of a frame, bytes.
pub const MAX_PAYLOAD: usize = 240;

/// Bytes of the CRC.
const CRC_BYTES: usize = 4;

/// Largest frame on the line, bytes: the CRC, one byte that COBS adds to up to 254, and a zero at each end.
pub const MAX_FRAME: usize = MAX_PAYLOAD + CRC_BYTES + 3;

/// CRC-32/ISO-HDLC, that of Ethernet and zip.
const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
