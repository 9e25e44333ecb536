//! The journal of a pump: an append-only file of entries, and the thread that announces the steps ahead.

mod announcer;
mod compaction;
mod entry;
mod journal;
mod line;
mod rotation;
mod story;
mod tail;

pub(crate) use announcer::Announcer;
pub(crate) use entry::{Entry, Why};
pub(crate) use journal::Journal;
pub use journal::Storage;
pub(super) use line::decode_numbered;
pub(crate) use line::{decode, encode};
pub(super) use rotation::parts;
pub use story::{JournalError, Story};
