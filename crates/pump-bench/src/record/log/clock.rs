//! The clock that gives doses their times.

use std::fmt::Debug;
use std::time::{SystemTime, UNIX_EPOCH};

use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::Stamp;

/// Clock that gives doses their times. People read them, and the safety limit of a day follows them. So do the dates of
/// calibrations, from which a tube's drift follows.
pub trait Clock: Debug + Send {
    /// Returns the present time.
    fn now(&self) -> Stamp;
}

/// Clock of this computer, with the offset of the system's time zone.
#[derive(Debug, Clone, Copy, Default)]
#[non_exhaustive]
pub struct SystemClock;

impl Clock for SystemClock {
    fn now(&self) -> Stamp {
        let unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |elapsed| elapsed.as_secs());
        let time = i64::try_from(unix_s).ok().and_then(|seconds| Timestamp::from_second(seconds).ok());
        let utc_offset_s = time.map_or(0, |time| TimeZone::system().to_offset(time).seconds());
        Stamp { unix_s, utc_offset_s }
    }
}
