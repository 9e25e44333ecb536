//! A leg along an envelope of speeds.

use libm::{sqrt, sqrtf};

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
        self.start_s + 2.0 * on_rad / (self.speed_rad_s + self.speed_at(turned_rad))
    }

    /// Returns the speed at which the rotor has turned `turned_rad`, rad/s.
    fn speed_at(&self, turned_rad: f64) -> f64 {
        let on_rad = turned_rad - self.from_rad;
        let square = self.speed_rad_s * self.speed_rad_s + 2.0 * self.acceleration_rad_s2 * on_rad;
        sqrt(square.max(0.0))
    }

    /// Returns the times of `n` steps after the rotor has turned `turned_rad`, in units of 1/`tick_hz`.
    pub(in crate::plan) fn times_after(
        &self,
        turned_rad: f64,
        step_rad: f64,
        tick_hz: f64,
    ) -> impl Fn(f32) -> f32 {
        let speed = self.speed_at(turned_rad) as f32;
        let (twice, doubled) =
            ((2.0 * step_rad * tick_hz) as f32, (2.0 * step_rad * self.acceleration_rad_s2) as f32);
        move |n| twice * n / (speed + sqrtf((speed * speed + doubled * n).max(0.0)))
    }
}
