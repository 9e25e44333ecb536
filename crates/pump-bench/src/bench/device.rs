//! The device of a session: its drive, with the limits that it sets.

use std::time::Instant;

use crate::drives::{Drive, DriveLimits};
use crate::pump_file::PumpFile;

/// Connected drive of a session.
#[derive(Debug)]
pub(super) struct Device<'a> {
    pub(super) drive: Box<dyn Drive + 'a>,
    /// Pump file with its motor as the device allows it.
    pub(super) file: PumpFile,
    pub(super) limits: Option<DriveLimits>,
    /// Instant from which on the motor holds.
    pub(super) holds_since: Instant,
}

impl Device<'_> {
    /// Returns the most steps that the device can count in a direction from where it stands. `None` without a bound.
    pub(super) fn most_steps(&self, reverse: bool) -> Option<u64> {
        let (farthest, count) = (self.drive.farthest_count()?, self.drive.count()?);
        let ahead = if reverse { farthest.saturating_add(count) } else { farthest.saturating_sub(count) };
        Some(u64::try_from(ahead).unwrap_or(0))
    }

    /// Returns the slowest cruise of the pump head, in rad/s.
    pub(super) fn least_rad_s(&self) -> f64 {
        self.limits.map_or(0.0, |limits| limits.min_speed_rad_s)
    }
}
