//! A leg along an envelope of speeds.

use libm::sqrt;

/// A leg along an envelope, from its first knot on. It gives the times of many angles in the leg.
#[derive(Debug, Clone, Copy)]
pub(in crate::plan) struct Along {
    /// Angle turned at the knot, rad.
    pub(super) from_rad: f64,
    /// Time at the knot, s since the start.
    pub(super) start_s: f64,
    /// Speed at the knot, rad/s.
    pub(super) speed_rad_s: f64,
    /// Acceleration of the leg, rad/s².
    pub(super) acceleration_rad_s2: f64,
}

impl Along {
    /// Returns the time at which the rotor has turned `turned_rad`, s since the start.
    pub(in crate::plan) fn time_of(&self, turned_rad: f64) -> f64 {
        let on_rad = turned_rad - self.from_rad;
        let square = self.speed_rad_s * self.speed_rad_s + 2.0 * self.acceleration_rad_s2 * on_rad;
        self.start_s + 2.0 * on_rad / (self.speed_rad_s + sqrt(square.max(0.0)))
    }
}
