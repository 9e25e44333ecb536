//! A bench: one pump, its drive, and its record.

mod announced_steps;
mod bench;
mod by_profile;
mod by_weight;
mod connection;
mod delivery;
mod device;
mod ended_motion;
mod homing;
mod lateness;
mod log;
mod ramps;
mod real_time;
mod recorded_motion;
mod rest;
mod safety;
mod series;
mod session;
mod stretches;

pub(crate) use bench::headline;
pub use bench::{Bench, head_print};
pub use by_profile::PreparedProfile;
pub use by_weight::{DeliveredByWeight, OrderByWeight, PreparedByWeight, ToleranceBy};
pub use delivery::Delivered;
pub use homing::AngleSet;
pub use log::LogReading;
pub(crate) use safety::system_now_s;
pub use safety::{Cleared, TimedVolume};
pub use series::{Rehearsal, SeriesMotion, SeriesRequest};
pub use session::{Accepted, NewTube, Session};
