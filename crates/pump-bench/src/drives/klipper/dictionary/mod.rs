//! The dictionary that a board tells of itself: its messages, its names for numbers, and its constants.
//!
//! Source: Klipper3d/klipper, `docs/Protocol.md`, "Data Dictionary".

mod constant;
mod dictionary;
mod document;
mod download;
mod enumeration;
mod error;
#[cfg(test)]
mod tests;

pub(super) use dictionary::Dictionary;
pub(super) use download::Download;
pub use error::DictionaryError;
