//! The shape of a motion's ramps: how long each leg of a change of speed takes.

use super::course::Course;

/// The shape of the ramps: one leg up to the plateau, two legs down to rest.
///
/// The times are fixed. A dose too short for its cruise speed has a lower plateau and equal times, so its
/// ramps ring a line no more than those of a long dose.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(in crate::plan) struct Shape {
    /// Time of the way up, s, positive.
    pub(in crate::plan) up_s: f64,
    /// Times of both legs of the way down, s, positive.
    pub(in crate::plan) down_s: [f64; 2],
    /// Speed between both legs of the way down, as a part of the plateau, between 0 and 1.
    pub(in crate::plan) between: f64,
}

impl Shape {
    /// Returns the shape with every leg slow enough for the acceleration of `course`, at plateaus up to
    /// `fastest_rad_s`.
    pub(in crate::plan) fn within(self, course: &Course, fastest_rad_s: f64) -> Self {
        let Self { up_s, down_s: [first_s, last_s], between } = self;
        let whole_s = fastest_rad_s.max(course.start_rad_s) / course.acceleration_rad_s2;
        let down_s = [first_s.max((1.0 - between) * whole_s), last_s.max(between * whole_s)];
        Self { up_s: up_s.max(whole_s), down_s, between }
    }

    /// Returns the shape with each leg shortened to a part of its time.
    pub(in crate::plan) fn shortened(self, part: f64) -> Self {
        Self { up_s: part * self.up_s, down_s: self.down_s.map(|leg_s| part * leg_s), ..self }
    }

    /// Returns the angle of the way down from a plateau of 1 rad/s, which is a mean time, s.
    pub(super) fn down_mean_s(&self) -> f64 {
        let Self { down_s: [first_s, last_s], between, .. } = *self;
        0.5 * ((1.0 + between) * first_s + between * last_s)
    }

    /// Returns the plateau of the motion over a turn, rad/s, if it must not be faster than `cruise_rad_s`. It
    /// is negative if the motion cannot stop so gently within the turn.
    pub(in crate::plan) fn plateau_rad_s(&self, course: &Course, cruise_rad_s: f64) -> f64 {
        let room_rad = course.turn_rad - 0.5 * course.start_rad_s * self.up_s;
        (room_rad / (0.5 * self.up_s + self.down_mean_s())).min(cruise_rad_s)
    }
}
