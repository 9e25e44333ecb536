//! The ramps that are tried, in units of the line's period.

use libm::{ceil, sqrt};
use pump_model::Line;
use pump_model::units::TURN_RAD;

use crate::plan::profile::{Course, Shape};

/// Units in the natural period of the outlet's line.
const UNITS: f64 = 16.0;

/// Units that the motor's own ramp to the cruise speed may take. A line that swings faster needs no gentler
/// ramp.
const MOTOR_UNITS: f64 = 8.0;

/// The grid of ramps: legs of whole units, of a cruise at a speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::plan) struct Grid {
    /// Length of a unit, s.
    pub(super) unit_s: f64,
    /// Units of the motor's own ramp from rest to the speed.
    pub(super) least: f64,
    course: Course,
    fastest_rad_s: f64,
}

/// A place in the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Units of the way up.
    pub(super) up: f64,
    /// Units of both legs of the way down.
    pub(super) down: [f64; 2],
    /// Speed between both legs of the way down, as a part of the plateau.
    pub(super) between: f64,
}

impl Place {
    /// Returns the places beside this one, with legs down that differ by `units` and a speed between them that
    /// differs by `part` of the plateau.
    pub(super) fn neighbours(self, units: f64, part: f64) -> impl Iterator<Item = Self> {
        let [first, last] = self.down;
        let beside = |first: f64, last: f64, between: f64| Self { down: [first, last], between, ..self };
        [
            beside(first + units, last, self.between),
            beside(first - units, last, self.between),
            beside(first, last + units, self.between),
            beside(first, last - units, self.between),
            beside(first, last, self.between + part),
            beside(first, last, self.between - part),
        ]
        .into_iter()
        .filter(|place| {
            place.down.iter().all(|units| *units >= 1.0) && (0.05..=0.95).contains(&place.between)
        })
    }
}

impl Grid {
    /// Makes the grid of a motion over `course` up to `cruise_rad_s`, or up to the speed that the motor can reach
    /// within the turn.
    pub(in crate::plan) fn new(outlet: &Line, course: &Course, cruise_rad_s: f64) -> Self {
        let Course { start_rad_s, turn_rad, acceleration_rad_s2, .. } = *course;
        let reached_rad_s = sqrt(acceleration_rad_s2 * turn_rad + 0.5 * start_rad_s * start_rad_s);
        let fastest_rad_s = cruise_rad_s.min(reached_rad_s);
        let period_s = TURN_RAD / outlet.natural_rad_s();
        let motor_s = fastest_rad_s.max(course.start_rad_s) / course.acceleration_rad_s2;
        let unit_s = (period_s / UNITS).max(motor_s / MOTOR_UNITS);
        Self { unit_s, least: ceil(motor_s / unit_s - 1e-6).max(1.0), course: *course, fastest_rad_s }
    }

    /// Returns the ramps that suit most doses at this speed, from any angle. `None` if the motion cannot stop so
    /// gently.
    pub(in crate::plan) fn usual(&self) -> Option<Shape> {
        self.shape(&Place { up: 8.0, down: [12.0, 12.0], between: 0.3 })
    }

    /// Returns the shape at a place, of whole units. `None` if the motion cannot stop so gently.
    pub(super) fn shape(&self, place: &Place) -> Option<Shape> {
        let legs = |units: f64, part: f64| units.max(ceil(part * self.least - 1e-6)) * self.unit_s;
        let [first, last] = place.down;
        let shape = Shape {
            up_s: legs(place.up, 1.0),
            down_s: [legs(first, 1.0 - place.between), legs(last, place.between)],
            between: place.between,
        };
        let shape = shape.within(&self.course, self.fastest_rad_s);
        (shape.plateau_rad_s(&self.course, self.fastest_rad_s) > 0.0).then_some(shape)
    }
}
