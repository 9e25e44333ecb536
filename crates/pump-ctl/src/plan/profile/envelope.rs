//! The envelope: a speed for every angle of a pitch.

use libm::{ceil, floor, sqrt};

/// Number of parts into which the uneven part of a pitch is cut.
pub(super) const PARTS: usize = 64;

/// A number for each part, in rows of 16.
pub(super) type PerPart = [[f64; 16]; PARTS / 16];

/// A periodic speed over the angle.
///
/// Knots are equally spaced over the part of the pitch in which the speed changes. The acceleration between
/// two knots is constant. The rest of the pitch has the speed of the first knot, which is also that of the
/// last knot.
///
/// Angles count in the direction of motion from the start of the uneven part. Part `PARTS` starts at the last
/// knot and ends with the pitch.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Envelope {
    pitch_rad: f64,
    uneven_rad: f64,
    /// Time of a pitch, s.
    period_s: f64,
    /// Speed at the start of each part, rad/s.
    speed_rad_s: PerPart,
    /// Time from the start of the pitch to the end of each part, s.
    time_s: PerPart,
}

/// A part of a certain pitch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Whole pitches before the part.
    pub(super) pitches: f64,
    /// Number of the part. `PARTS` is the even part.
    pub(super) part: usize,
}

impl Place {
    /// Returns the part that follows.
    pub(super) fn next(self) -> Self {
        if self.part < PARTS {
            Self { part: self.part + 1, ..self }
        } else {
            Self { pitches: self.pitches + 1.0, part: 0 }
        }
    }
}

impl Place {
    /// Returns the part that comes before.
    fn before(self) -> Self {
        match self.part.checked_sub(1) {
            Some(part) => Self { part, ..self },
            None => Self { pitches: self.pitches - 1.0, part: PARTS },
        }
    }
}

impl Envelope {
    /// Makes an envelope from the squares of the speeds at the knots, all positive.
    pub(super) fn new(pitch_rad: f64, uneven_rad: f64, squares: &PerPart) -> Self {
        let mut envelope = Self {
            pitch_rad,
            uneven_rad,
            period_s: 0.0,
            speed_rad_s: squares.map(|row| row.map(sqrt)),
            time_s: [[0.0; 16]; PARTS / 16],
        };
        let mut times = [[0.0; 16]; PARTS / 16];
        let mut time_s = 0.0;
        for (part, slot) in times.as_flattened_mut().iter_mut().enumerate() {
            time_s += 2.0 * envelope.part_rad() / (envelope.knot_rad_s(part) + envelope.knot_rad_s(part + 1));
            *slot = time_s;
        }
        envelope.time_s = times;
        envelope.period_s = time_s + (pitch_rad - uneven_rad) / envelope.knot_rad_s(0);
        envelope
    }

    pub(super) fn pitch_rad(&self) -> f64 {
        self.pitch_rad
    }

    /// Returns the mean speed over time, rad/s.
    pub(super) fn mean_rad_s(&self) -> f64 {
        self.pitch_rad / self.period_s
    }

    /// Returns the slowest speed, rad/s. It is the speed at a knot.
    pub(super) fn slowest_rad_s(&self) -> f64 {
        self.speed_rad_s.as_flattened().iter().copied().fold(f64::INFINITY, f64::min)
    }

    fn part_rad(&self) -> f64 {
        self.uneven_rad / PARTS as f64
    }

    /// Returns the speed at the start of a part, rad/s. The even part starts and ends at the speed of the
    /// first part.
    pub(super) fn knot_rad_s(&self, part: usize) -> f64 {
        let [[first, ..], ..] = &self.speed_rad_s;
        *self.speed_rad_s.as_flattened().get(part).unwrap_or(first)
    }

    /// Returns the angle within the pitch at which a part starts, rad. `PARTS + 1` gives the end of the
    /// pitch.
    fn knot_rad(&self, part: usize) -> f64 {
        if part > PARTS { self.pitch_rad } else { part as f64 * self.part_rad() }
    }

    /// Returns the time from the start of the pitch to the start of a part, s.
    fn knot_s(&self, part: usize) -> f64 {
        part.checked_sub(1)
            .map_or(0.0, |before| *self.time_s.as_flattened().get(before).unwrap_or(&self.period_s))
    }

    /// Returns the angles at which a part starts and ends, rad.
    pub(super) fn ends_rad(&self, place: Place) -> (f64, f64) {
        let base_rad = place.pitches * self.pitch_rad;
        (base_rad + self.knot_rad(place.part), base_rad + self.knot_rad(place.part + 1))
    }

    /// Returns the part in which an angle lies.
    pub(super) fn place_at(&self, angle_rad: f64) -> Place {
        let pitches = floor(angle_rad / self.pitch_rad);
        let local_rad = (angle_rad - pitches * self.pitch_rad).max(0.0);
        let part = if local_rad < self.uneven_rad {
            // The quotient is not below zero, and a count of parts at most.
            ((local_rad / self.part_rad()) as usize).min(PARTS - 1)
        } else {
            PARTS
        };
        Place { pitches, part }
    }

    /// Returns the part that is under way `time_s` after angle 0.
    pub(super) fn place_at_time(&self, time_s: f64) -> Place {
        let pitches = floor(time_s / self.period_s);
        let local_s = time_s - pitches * self.period_s;
        let part = self.time_s.as_flattened().partition_point(|end_s| *end_s <= local_s);
        Place { pitches, part }
    }

    /// Returns the acceleration in a part, rad/s².
    pub(super) fn acceleration_rad_s2(&self, part: usize) -> f64 {
        let length_rad = self.knot_rad(part + 1) - self.knot_rad(part);
        if part >= PARTS || length_rad <= 0.0 {
            return 0.0;
        }
        let (from, to) = (self.knot_rad_s(part), self.knot_rad_s(part + 1));
        (to - from) * (to + from) / (2.0 * length_rad)
    }

    /// Returns the square of the speed at an angle in a part, rad²/s².
    fn square_in(&self, place: Place, angle_rad: f64) -> f64 {
        let from = self.knot_rad_s(place.part);
        let turned_rad = angle_rad - self.ends_rad(place).0;
        (from * from + 2.0 * self.acceleration_rad_s2(place.part) * turned_rad).max(0.0)
    }

    /// Returns the square of the speed at an angle, rad²/s².
    pub(super) fn square_at(&self, angle_rad: f64) -> f64 {
        self.square_in(self.place_at(angle_rad), angle_rad)
    }

    /// Returns the speed at an angle, rad/s.
    pub(super) fn speed_at(&self, angle_rad: f64) -> f64 {
        sqrt(self.square_at(angle_rad))
    }

    /// Returns the time from angle 0 to an angle, s.
    pub(super) fn time_at(&self, angle_rad: f64) -> f64 {
        self.time_in(self.place_at(angle_rad), angle_rad)
    }

    /// Returns the time from angle 0 to an angle in a part, s.
    pub(super) fn time_in(&self, place: Place, angle_rad: f64) -> f64 {
        let turned_rad = angle_rad - self.ends_rad(place).0;
        let speeds = self.knot_rad_s(place.part) + sqrt(self.square_in(place, angle_rad));
        place.pitches * self.period_s + self.knot_s(place.part) + 2.0 * turned_rad / speeds
    }

    /// Returns the angle of the first knot at `angle_rad` or beyond, rad.
    pub(super) fn knot_from(&self, angle_rad: f64) -> f64 {
        let pitches = floor(angle_rad / self.pitch_rad);
        let local_rad = (angle_rad - pitches * self.pitch_rad).max(0.0);
        let part = ceil(local_rad / self.part_rad());
        let knot_rad = if part <= PARTS as f64 { part * self.part_rad() } else { self.pitch_rad };
        pitches * self.pitch_rad + knot_rad
    }

    /// Returns the largest speed between two angles, rad/s. It is the speed at a knot or at an end, since no
    /// larger speed lies between knots.
    pub(super) fn largest_between(&self, from_rad: f64, to_rad: f64) -> f64 {
        let mut place = self.place_at(from_rad).next();
        let mut largest = self.speed_at(from_rad).max(self.speed_at(to_rad));
        // A pitch has every knot.
        for _ in 0..=PARTS {
            if self.ends_rad(place).0 >= to_rad {
                break;
            }
            largest = largest.max(self.knot_rad_s(place.part));
            place = place.next();
        }
        largest
    }

    /// Finds the first angle on the way from `from_rad` to `to_rad` at which a straight line is no longer below
    /// the square of the speed. The way may go either way. `None` if the line stays below.
    pub(super) fn meeting(&self, from_rad: f64, to_rad: f64, line: impl Fn(f64) -> f64) -> Option<f64> {
        let onward = to_rad > from_rad;
        let gap = |place: Place, angle_rad: f64| line(angle_rad) - self.square_in(place, angle_rad);
        let mut place = self.place_at(from_rad);
        let (mut here_rad, mut here) = (from_rad, gap(place, from_rad));
        loop {
            if here >= 0.0 {
                return Some(here_rad);
            }
            let (start_rad, end_rad) = self.ends_rad(place);
            let next_rad = if onward { end_rad.min(to_rad) } else { start_rad.max(to_rad) };
            let next = gap(place, next_rad);
            if next >= 0.0 {
                return Some(here_rad + (next_rad - here_rad) * here / (here - next));
            }
            let is_there = if onward { next_rad >= to_rad } else { next_rad <= to_rad };
            if is_there {
                return None;
            }
            place = if onward { place.next() } else { place.before() };
            (here_rad, here) = (next_rad, gap(place, next_rad));
        }
    }

    /// Finds the first angle in the pitch from `from_rad` at which a straight line is no longer below the
    /// square of the speed. With a `sign` of -1 it is the first angle at which the line is no longer above.
    /// The gap times `sign` must not fall.
    pub(super) fn crossing(&self, from_rad: f64, line: impl Fn(f64) -> f64, sign: f64) -> f64 {
        let gap = |place: Place, angle_rad: f64| sign * (line(angle_rad) - self.square_in(place, angle_rad));
        let mut place = self.place_at(from_rad);
        let (mut low_rad, mut low) = (from_rad, gap(place, from_rad));
        // The part in which the search starts comes twice.
        for _ in 0..=PARTS + 1 {
            if low >= 0.0 {
                break;
            }
            let high_rad = self.ends_rad(place).1.max(low_rad);
            let high = gap(place, high_rad);
            if high >= 0.0 {
                return low_rad + (high_rad - low_rad) * low / (low - high);
            }
            (low_rad, low) = (high_rad, high);
            place = place.next();
        }
        low_rad
    }
}
