//! The safety limits of a bench: no motion begins that would exceed one, and a pump that stands
//! is cleared by a person.

mod check;
mod clear;
mod disturbed;
mod order;
mod reason;
mod run_bounds;
mod timed_volume;

pub(crate) use check::system_now_s;
pub use clear::Cleared;
pub(crate) use run_bounds::RunBounds;
pub use timed_volume::TimedVolume;
