//! The schedule of a laboratory's doses: a TOML file of the schema `schedule/1`.
//!
//! [`Schedule::read`] reads and checks the file. [`Schedule::due`] lists the planned runs between two instants,
//! [`Schedule::next`] finds the next of one entry, and [`Schedule::catch_up`] says what a service runs now and what it
//! reports as missed. Nothing here reads the clock: the caller gives the time.

mod action;
mod catchup;
mod days;
mod due;
mod duration;
mod entry;
mod error;
mod keys;
mod overlap;
mod place;
mod policy;
mod schedule;
mod timing;
mod written;

pub use jiff::{Timestamp, tz::TimeZone};

#[cfg(feature = "serve")]
pub(crate) use self::action::NO_OPTIONS;
pub use self::action::{Action, Batch, Setting};
pub use self::catchup::{Ahead, Catchup, Missed};
pub use self::days::Days;
pub use self::due::Due;
pub use self::duration::Duration;
pub use self::entry::Entry;
pub use self::error::{Place, ScheduleError};
pub use self::overlap::Meeting;
pub use self::place::Shift;
pub use self::policy::{IfBusy, IfMissed, IfUnfinished};
pub use self::schedule::Schedule;
pub use self::timing::Timing;
