//! The turn that a profile covers, and the speed limit along it.

/// The speed limit at each angle.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(in crate::plan) enum SpeedLimit {
    /// One speed at every angle.
    Constant {
        /// rad/s.
        rad_s: f64,
    },
    /// The speeds that keep the flow at the outlet's rollers below `flow_ml_s`, within the acceleration.
    Smooth {
        /// mL/s.
        flow_ml_s: f64,
        /// The motor's largest speed, rad/s.
        max_rad_s: f64,
    },
}

/// All that a profile follows from.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(in crate::plan) struct Course {
    /// Angle of the rollers at the start, rad.
    pub(in crate::plan) start_rad: f64,
    /// 1 or -1.
    pub(in crate::plan) direction: i8,
    /// Speed at the start, rad/s, not negative.
    pub(in crate::plan) start_rad_s: f64,
    /// Angle to turn, rad: not negative, and enough to stop from the start speed, start² / (2 acceleration).
    pub(in crate::plan) turn_rad: f64,
    /// Largest acceleration, rad/s², positive.
    pub(in crate::plan) acceleration_rad_s2: f64,
    /// Speed limit along the turn.
    pub(in crate::plan) limit: SpeedLimit,
}
