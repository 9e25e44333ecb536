//! The log of a pump: one line a dose, with its time, for people. The journal is the record; the log follows from it.

mod clock;
mod clock_watch;
mod ended;
mod entry;
mod file;
mod moment;
mod pending;
mod stamp;
mod told;

pub use clock::{Clock, SystemClock};
pub use clock_watch::{ClockJump, ClockWatch};
pub use ended::LogEnd;
pub use entry::LogEntry;
pub(crate) use entry::LogPlace;
pub(crate) use file::{Log, LogTail};
pub use file::{LogError, LogLine};
pub use moment::{MomentError, moment};
pub(crate) use pending::pending;
pub use stamp::Stamp;
pub(crate) use told::Told;
