//! The way of a motion down to rest.

/// The way down to rest in two legs. The first takes no time if the motor brakes as fast as it can.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Down {
    /// Times of both legs, s.
    pub(super) legs_s: [f64; 2],
    /// Decelerations of both legs, rad/s².
    pub(super) legs_rad_s2: [f64; 2],
    /// Angle turned between both legs, rad.
    pub(super) between_rad: f64,
    /// Speed between both legs, rad/s.
    pub(super) between_rad_s: f64,
}

impl Down {
    /// Makes the way down from a speed in one leg of `time_s` that starts at `left_rad`.
    pub(super) fn plain(left_rad: f64, speed_rad_s: f64, time_s: f64, deceleration_rad_s2: f64) -> Self {
        Self {
            legs_s: [0.0, time_s],
            legs_rad_s2: [deceleration_rad_s2; 2],
            between_rad: left_rad,
            between_rad_s: speed_rad_s,
        }
    }

    /// Returns the time from the start of the way down to rest, s.
    pub(super) fn duration_s(&self) -> f64 {
        let [first_s, last_s] = self.legs_s;
        first_s + last_s
    }
}
