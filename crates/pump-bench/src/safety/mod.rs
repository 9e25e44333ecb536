//! Safety limits: volumes that a pump never exceeds, and the stand of a pump that would have, or was ordered to.
//!
//! Nothing here reads a clock: the wall time comes in as a value.

mod account;
mod day;
mod limits;
mod passed_time;
mod stand;
mod unfinished;

pub(crate) use account::SafetyAccount;
pub use day::DAY_S;
pub use limits::SafetyLimits;
pub(crate) use passed_time::clock_behind;
pub use stand::{SafetyLimit, Stand, StandReason};
pub use unfinished::UnfinishedPolicy;
