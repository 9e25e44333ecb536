//! The log of a session: each dose gets its entry with the rest that the journal records after it.

mod entries;
mod reading;
mod session_log;

pub use reading::LogReading;
pub(super) use session_log::SessionLog;
