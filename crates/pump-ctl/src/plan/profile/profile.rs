//! The profile of the speed: from the start speed to the speed limit, along it, and down to rest.

use libm::{floor, sqrt};
use pump_model::{FlowCurve, Leg};

use super::along::Along;
use super::course::{Course, SpeedLimit};
use super::down::Down;
use super::envelope::{Envelope, PARTS, Place};
use super::shape::Shape;
use super::smooth;

/// The motion over a turn that ends at rest, below a speed limit and within an acceleration.
///
/// The ramps have the shape of the course. Without a shape the motion is the fastest motion.
///
/// The speed limit may depend on the angle. With u = omega²/2 over the angle, an acceleration is a slope. So
/// the profile is the smallest of three: the line up (or down) from the start with that slope, the limit, and
/// the line down to the end. The limit itself is nowhere steeper, so it falls below the first line once and
/// rises above the last line once. The motion goes up, along and down, or up and down if the turn is too
/// short. A constant limit makes a trapezoid.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Profile {
    pub(in crate::plan) course: Course,
    /// Envelope of the speed limit, if the limit is not constant.
    pub(super) envelope: Option<Envelope>,
    /// Angle in the envelope at the start, rad.
    pub(super) phase_rad: f64,
    /// Time from angle 0 of the envelope to where the limit is reached, s.
    pub(super) reached_s: f64,
    /// Angles turned where the limit is reached and left, rad.
    pub(in crate::plan) corners_rad: [f64; 2],
    /// Speeds where the limit is reached and left, rad/s.
    pub(super) corner_rad_s: [f64; 2],
    pub(super) ramp_s: f64,
    pub(super) along_s: f64,
    /// Acceleration of the first ramp, rad/s². It is negative if the rotor is faster than the limit at first.
    pub(super) ramp_rad_s2: f64,
    pub(super) down: Down,
    pub(super) reaches_limit: bool,
}

impl Profile {
    /// Makes the profile of `course` on a pump whose outlet has this curve.
    pub(in crate::plan) fn new(course: Course, curve: &FlowCurve) -> Self {
        match course.limit {
            SpeedLimit::Constant { rad_s } => Self::constant(course, rad_s),
            SpeedLimit::Smooth(limit) => {
                let (envelope, phase_rad) = smooth::envelope(curve, &course, &limit);
                Self::along(course, envelope, phase_rad)
            }
        }
    }

    /// Returns this profile with ramps of another shape. Its envelope stays.
    pub(in crate::plan) fn with_shape(&self, shape: Option<Shape>) -> Self {
        let course = Course { shape, ..self.course };
        match (self.envelope, course.limit) {
            (Some(envelope), _) => Self::along(course, envelope, self.phase_rad),
            (None, SpeedLimit::Constant { rad_s }) => Self::constant(course, rad_s),
            // A smooth profile has an envelope.
            (None, SpeedLimit::Smooth { .. }) => *self,
        }
    }

    /// Makes the profile below a constant limit.
    fn constant(course: Course, cruise_rad_s: f64) -> Self {
        if let Some(shape) = course.shape {
            return Self::shaped(course, shape, cruise_rad_s);
        }
        let Course { start_rad_s, turn_rad, acceleration_rad_s2, .. } = course;
        // Up to the peak and down from it turns (2 peak² - start²) / (2 acceleration).
        let peak_rad_s = sqrt(acceleration_rad_s2 * turn_rad + 0.5 * start_rad_s * start_rad_s);
        let plateau_rad_s = cruise_rad_s.min(peak_rad_s);
        let ramp_s = (plateau_rad_s - start_rad_s).abs() / acceleration_rad_s2;
        let down_s = plateau_rad_s / acceleration_rad_s2;
        let ramp_rad = 0.5 * (start_rad_s + plateau_rad_s) * ramp_s;
        let down_rad = 0.5 * plateau_rad_s * down_s;
        let along_rad = turn_rad - (ramp_rad + down_rad);
        let along_s = if plateau_rad_s > 0.0 { (along_rad / plateau_rad_s).max(0.0) } else { 0.0 };
        Self {
            course,
            envelope: None,
            phase_rad: 0.0,
            reached_s: 0.0,
            corners_rad: [ramp_rad, turn_rad - down_rad],
            corner_rad_s: [plateau_rad_s; 2],
            ramp_s,
            along_s,
            ramp_rad_s2: towards(start_rad_s, plateau_rad_s, acceleration_rad_s2),
            down: Down::plain(turn_rad - down_rad, plateau_rad_s, down_s, acceleration_rad_s2),
            reaches_limit: plateau_rad_s >= cruise_rad_s,
        }
    }

    /// Makes the profile below an envelope, at whose angle `phase_rad` the motion starts.
    pub(super) fn along(course: Course, envelope: Envelope, phase_rad: f64) -> Self {
        if let Some(shape) = course.shape {
            return Self::shaped_along(course, shape, envelope, phase_rad);
        }
        let Course { start_rad_s, turn_rad, acceleration_rad_s2, .. } = course;
        // Squares of speeds are 2 u. They change by `slope` a radian at most, and by `a_pitch` a pitch.
        let slope = 2.0 * acceleration_rad_s2;
        let a_pitch = slope * envelope.pitch_rad();
        let square = start_rad_s * start_rad_s;

        let gap = envelope.square_at(phase_rad) - square;
        let sign = if gap < 0.0 { -1.0 } else { 1.0 };
        let pitches = floor(gap.abs() / a_pitch);
        let line = |angle_rad: f64| square + sign * slope * (angle_rad - phase_rad);
        let reached_rad = envelope.crossing(phase_rad + pitches * envelope.pitch_rad(), line, sign);

        let end_rad = phase_rad + turn_rad;
        let pitches = floor(envelope.square_at(end_rad) / a_pitch) + 1.0;
        let line = |angle_rad: f64| slope * (end_rad - angle_rad);
        let left_rad = envelope.crossing(end_rad - pitches * envelope.pitch_rad(), line, -1.0);

        if reached_rad > left_rad {
            return Self { envelope: Some(envelope), phase_rad, ..Self::constant(course, f64::INFINITY) };
        }
        let corner_rad_s = [reached_rad, left_rad].map(|angle_rad| envelope.speed_at(angle_rad));
        let reached_s = envelope.time_at(reached_rad);
        let ramp_s = (corner_rad_s[0] - start_rad_s).abs() / acceleration_rad_s2;
        let down_s = corner_rad_s[1] / acceleration_rad_s2;
        Self {
            course,
            envelope: Some(envelope),
            phase_rad,
            reached_s,
            corners_rad: [reached_rad - phase_rad, left_rad - phase_rad],
            corner_rad_s,
            ramp_s,
            along_s: envelope.time_at(left_rad) - reached_s,
            ramp_rad_s2: towards(start_rad_s, corner_rad_s[0], acceleration_rad_s2),
            down: Down::plain(left_rad - phase_rad, corner_rad_s[1], down_s, acceleration_rad_s2),
            reaches_limit: true,
        }
    }

    /// Returns the fastest speed that is reached, rad/s.
    pub fn peak_rad_s(&self) -> f64 {
        let along = match self.along_envelope() {
            Some(envelope) => {
                let [from, to] = self.corners_rad.map(|corner_rad| self.phase_rad + corner_rad);
                envelope.largest_between(from, to)
            }
            None => self.corner_rad_s[0],
        };
        along.max(self.course.start_rad_s)
    }

    /// Returns the slowest speed along the speed limit, rad/s.
    pub(in crate::plan) fn slowest_rad_s(&self) -> f64 {
        self.along_envelope().map_or(self.corner_rad_s[0], Envelope::slowest_rad_s)
    }

    /// Returns the cruise speed, rad/s. It is the fastest speed that is reached, or the mean over time of a
    /// limit that depends on the angle.
    pub fn cruise_rad_s(&self) -> f64 {
        self.along_envelope().map_or_else(|| self.peak_rad_s(), Envelope::mean_rad_s)
    }

    /// Returns true if the motion reaches the speed limit.
    pub fn reaches_limit(&self) -> bool {
        self.reaches_limit
    }

    /// Returns the largest acceleration that the motor allows, rad/s². A stop brakes with it. The ramps are no
    /// steeper.
    pub fn acceleration_rad_s2(&self) -> f64 {
        self.course.acceleration_rad_s2
    }

    /// Returns the speed limit, or its mean over time if it depends on the angle, rad/s.
    pub(in crate::plan) fn limit_rad_s(&self) -> f64 {
        match (&self.envelope, self.course.limit) {
            (Some(envelope), _) => envelope.mean_rad_s(),
            (None, SpeedLimit::Constant { rad_s }) => rad_s,
            (None, SpeedLimit::Smooth(limit)) => limit.max_rad_s,
        }
    }

    /// Returns the time at which the first ramp ends, s.
    pub(in crate::plan) fn reached_limit_s(&self) -> f64 {
        self.ramp_s
    }

    /// Returns the time at which the way down begins, s.
    pub(in crate::plan) fn left_s(&self) -> f64 {
        self.ramp_s + self.along_s
    }

    /// Returns both legs down to rest.
    pub(in crate::plan) fn down_legs(&self) -> [Leg; 2] {
        [self.first_down_leg(), self.last_down_leg()]
    }

    /// Returns the time of the first leg down, s.
    pub(in crate::plan) fn first_down_s(&self) -> f64 {
        self.down.legs_s[0]
    }

    /// Returns the time from start to rest, s.
    pub fn duration_s(&self) -> f64 {
        self.ramp_s + self.down.duration_s() + self.along_s
    }

    /// Returns the envelope, if there is one and the motion reaches it.
    fn along_envelope(&self) -> Option<&Envelope> {
        self.envelope.as_ref().filter(|_| self.reaches_limit)
    }

    /// Returns the time at which the rotor has turned `turned_rad`, s since the start. An angle outside [0,
    /// turn] gives the time of the nearer end.
    pub fn time_of(&self, turned_rad: f64) -> f64 {
        let [reached_rad, left_rad] = self.corners_rad;
        if turned_rad <= reached_rad {
            let turned_rad = turned_rad.max(0.0);
            let mean_rad_s = 0.5 * (self.course.start_rad_s + self.speed_at(turned_rad));
            if mean_rad_s > 0.0 { turned_rad / mean_rad_s } else { 0.0 }
        } else if turned_rad > self.down.between_rad {
            let left_rad = (self.course.turn_rad - turned_rad).max(0.0);
            self.duration_s() - sqrt(2.0 * left_rad / self.down.legs_rad_s2[1])
        } else if turned_rad > left_rad {
            let left_rad = self.down.between_rad - turned_rad;
            let sum_rad_s = self.down.between_rad_s + self.speed_at(turned_rad);
            self.duration_s() - self.down.legs_s[1] - 2.0 * left_rad / sum_rad_s
        } else if let Some(envelope) = self.along_envelope() {
            self.ramp_s + (envelope.time_at(self.phase_rad + turned_rad) - self.reached_s)
        } else {
            self.ramp_s + (turned_rad - reached_rad) / self.corner_rad_s[0]
        }
    }

    /// Returns the speed when the rotor has turned `turned_rad`, rad/s.
    pub(in crate::plan) fn speed_at(&self, turned_rad: f64) -> f64 {
        let [reached_rad, left_rad] = self.corners_rad;
        let start_rad_s = self.course.start_rad_s;
        let square = if turned_rad <= reached_rad {
            start_rad_s * start_rad_s + 2.0 * self.ramp_rad_s2 * turned_rad
        } else if turned_rad > self.down.between_rad {
            2.0 * self.down.legs_rad_s2[1] * (self.course.turn_rad - turned_rad)
        } else if turned_rad > left_rad {
            let square = self.down.between_rad_s * self.down.between_rad_s;
            square + 2.0 * self.down.legs_rad_s2[0] * (self.down.between_rad - turned_rad)
        } else {
            return self
                .along_envelope()
                .map_or(self.corner_rad_s[0], |envelope| envelope.speed_at(self.phase_rad + turned_rad));
        };
        sqrt(square.max(0.0))
    }

    /// Returns the first angle turned, at `turned_rad` or beyond, at which the acceleration changes, rad.
    pub(in crate::plan) fn corner_from(&self, turned_rad: f64) -> f64 {
        let [reached_rad, left_rad] = self.corners_rad;
        if turned_rad <= reached_rad {
            reached_rad
        } else if turned_rad > self.down.between_rad {
            self.course.turn_rad
        } else if turned_rad > left_rad {
            self.down.between_rad
        } else {
            self.along_envelope().map_or(left_rad, |envelope| {
                (envelope.knot_from(self.phase_rad + turned_rad) - self.phase_rad).min(left_rad)
            })
        }
    }

    /// Returns the leg along the envelope when the rotor has turned `turned_rad`, or `None` off the envelope.
    pub(in crate::plan) fn along_at(&self, turned_rad: f64) -> Option<Along> {
        let [reached_rad, left_rad] = self.corners_rad;
        let envelope =
            self.along_envelope().filter(|_| turned_rad > reached_rad && turned_rad <= left_rad)?;
        let place = envelope.place_at(self.phase_rad + turned_rad);
        let (from_rad, _) = envelope.ends_rad(place);
        Some(Along {
            from_rad: from_rad - self.phase_rad,
            start_s: self.ramp_s + (envelope.time_in(place, from_rad) - self.reached_s),
            speed_rad_s: envelope.knot_rad_s(place.part),
            acceleration_rad_s2: envelope.acceleration_rad_s2(place.part),
        })
    }

    /// Returns the leg under way at `t_s`.
    pub(in crate::plan) fn leg_at(&self, t_s: f64) -> Leg {
        if t_s < self.ramp_s {
            self.ramp_leg()
        } else if t_s < self.ramp_s + self.along_s {
            self.along_envelope().map_or_else(
                || self.even_leg(),
                |envelope| {
                    self.leg_along(envelope, envelope.place_at_time(self.reached_s + (t_s - self.ramp_s)))
                },
            )
        } else if t_s < self.ramp_s + self.along_s + self.down.legs_s[0] {
            self.first_down_leg()
        } else {
            self.last_down_leg()
        }
    }

    fn leg(
        &self,
        start_s: f64,
        duration_s: f64,
        turned_rad: f64,
        speed_rad_s: f64,
        acceleration_rad_s2: f64,
    ) -> Leg {
        let sign = f64::from(self.course.direction);
        Leg {
            start_s,
            duration_s,
            angle_rad: self.course.start_rad + sign * turned_rad,
            speed_rad_s: sign * speed_rad_s,
            acceleration_rad_s2: sign * acceleration_rad_s2,
        }
    }

    /// Returns the leg from the start to the limit.
    pub(super) fn ramp_leg(&self) -> Leg {
        self.leg(0.0, self.ramp_s, 0.0, self.course.start_rad_s, self.ramp_rad_s2)
    }

    /// Returns the leg along a constant limit.
    pub(super) fn even_leg(&self) -> Leg {
        self.leg(self.ramp_s, self.along_s, self.corners_rad[0], self.corner_rad_s[0], 0.0)
    }

    /// Returns the first leg down from the limit. It takes no time if the way down is one leg.
    pub(super) fn first_down_leg(&self) -> Leg {
        let start_s = self.ramp_s + self.along_s;
        let Down { legs_s: [first_s, _], legs_rad_s2: [down_rad_s2, _], .. } = self.down;
        self.leg(start_s, first_s, self.corners_rad[1], self.corner_rad_s[1], -down_rad_s2)
    }

    /// Returns the last leg, down to rest.
    pub(super) fn last_down_leg(&self) -> Leg {
        let Down { legs_s: [first_s, last_s], legs_rad_s2: [_, down_rad_s2], between_rad, between_rad_s } =
            self.down;
        let start_s = self.ramp_s + self.along_s + first_s;
        self.leg(start_s, last_s, between_rad, between_rad_s, -down_rad_s2)
    }

    /// Returns the leg along one part of an envelope. Its duration is 0 if the motion does not follow the
    /// limit there.
    fn leg_along(&self, envelope: &Envelope, place: Place) -> Leg {
        let [reached_rad, left_rad] = self.corners_rad.map(|corner_rad| self.phase_rad + corner_rad);
        let (start_rad, end_rad) = envelope.ends_rad(place);
        let start_rad = start_rad.max(reached_rad);
        let end_rad = end_rad.min(left_rad).max(start_rad);
        let [start_s, end_s] = [start_rad, end_rad]
            .map(|angle_rad| self.ramp_s + (envelope.time_in(place, angle_rad) - self.reached_s));
        let speed_rad_s = envelope.speed_at(start_rad);
        let acceleration_rad_s2 = envelope.acceleration_rad_s2(place.part);
        self.leg(start_s, end_s - start_s, start_rad - self.phase_rad, speed_rad_s, acceleration_rad_s2)
    }

    /// Returns the place along the envelope where the limit is reached. The result is `None` for a constant
    /// limit, or if the limit is not reached.
    pub(super) fn first_place(&self) -> Option<Place> {
        self.along_envelope().map(|envelope| envelope.place_at(self.phase_rad + self.corners_rad[0]))
    }

    /// Returns the leg at `place`, or `None` after the last leg.
    pub(super) fn leg_at_place(&self, place: Place) -> Option<Leg> {
        let envelope = self.along_envelope()?;
        let begins_rad = envelope.ends_rad(place).0;
        (begins_rad < self.phase_rad + self.corners_rad[1]).then(|| self.leg_along(envelope, place))
    }

    /// Returns the legs of a pitch of the envelope, from time 0, wherever the motion starts and ends. A
    /// constant limit has no legs.
    pub(in crate::plan) fn pitch_along(&self) -> impl Iterator<Item = Leg> + Clone {
        self.envelope.iter().flat_map(|envelope| {
            (0..=PARTS).map(|part| {
                let place = Place { pitches: 0.0, part };
                let (start_rad, end_rad) = envelope.ends_rad(place);
                let [start_s, end_s] =
                    [start_rad, end_rad].map(|angle_rad| envelope.time_in(place, angle_rad));
                let speed_rad_s = envelope.speed_at(start_rad);
                let acceleration_rad_s2 = envelope.acceleration_rad_s2(part);
                let turned_rad = start_rad - self.phase_rad;
                self.leg(start_s, end_s - start_s, turned_rad, speed_rad_s, acceleration_rad_s2)
            })
        })
    }
}

/// Returns the acceleration from one speed to another, rad/s².
fn towards(from_rad_s: f64, to_rad_s: f64, acceleration_rad_s2: f64) -> f64 {
    if from_rad_s > to_rad_s { -acceleration_rad_s2 } else { acceleration_rad_s2 }
}
