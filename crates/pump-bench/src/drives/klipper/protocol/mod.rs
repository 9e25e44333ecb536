//! The bytes of the protocol: numbers of variable length, messages by their format strings, and blocks.
//!
//! Source: Klipper3d/klipper, `docs/Protocol.md`.

mod block;
mod error;
mod format;
mod kind;
mod message;
mod number;
#[cfg(test)]
mod tests;

pub(super) use block::{BLOCK_MOST, Block, BlockReader, CONTENT_MOST, SYNC, block};
pub use error::MessageError;
pub(super) use format::Format;
pub(super) use kind::Kind;
pub(super) use message::{Message, Value};
