//! The turn that a profile covers, and the speed limit along it.

use super::shape::Shape;
use super::smooth::SmoothLimit;

/// The speed limit at each angle.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(in crate::plan) enum SpeedLimit {
    /// The limit is one speed at every angle.
    Constant {
        /// Speed limit, rad/s.
        rad_s: f64,
    },
    /// The limit keeps the flow at the outlet's rollers or at the line's end even, within the acceleration.
    Smooth(SmoothLimit),
}

/// The quantities that determine a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(in crate::plan) struct Course {
    /// Angle of the rollers at the start, rad.
    pub(in crate::plan) start_rad: f64,
    /// Direction: 1 forward, -1 in reverse.
    pub(in crate::plan) direction: i8,
    /// Speed at the start, rad/s, not negative.
    pub(in crate::plan) start_rad_s: f64,
    /// Angle to turn, rad, not negative. It is enough to stop from the start speed, start² / (2
    /// acceleration).
    pub(in crate::plan) turn_rad: f64,
    /// Largest acceleration, rad/s², positive.
    pub(in crate::plan) acceleration_rad_s2: f64,
    /// Speed limit along the turn.
    pub(in crate::plan) limit: SpeedLimit,
    /// Shape of the ramps. `None` is the largest acceleration, up and down.
    pub(in crate::plan) shape: Option<Shape>,
}
