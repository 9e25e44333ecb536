//! The speeds at which the flow is as smooth as the motor allows: at the outlet's rollers, or at the end of
//! the outlet line where that amplifies what is left of the ripple.

use libm::{sqrt, sqrtf};
use pump_model::units::wrap;
use pump_model::{FlowCurve, Pump};

use super::course::Course;
use super::envelope::{Envelope, PARTS, PerPart};
use super::lift::Lift;
use super::lift_choice::Search;
use super::swing::Swing;

/// A flow limit, and the part of the pulse in which it does not hold.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(in crate::plan) struct SmoothLimit {
    /// Flow limit, mL/s.
    flow_ml_s: f64,
    /// The motor's largest speed, rad/s.
    pub(super) max_rad_s: f64,
    /// Part of the pulse in which the flow limit does not hold, if there is one.
    lift: Option<Lift>,
}

/// The flow per radian at the knots of the uneven part, and the bounds of the speed there.
struct SmoothKnots {
    pitch_rad: f64,
    /// Start of the uneven part, as an angle in the direction of motion, rad.
    origin_rad: f64,
    uneven_rad: f64,
    /// Inverse square of the flow per radian at each knot, 1/q², rad²/mL².
    per_square: PerPart,
    /// Largest change of the square of the speed from knot to knot, rad²/s².
    rise: f64,
    /// Square of the motor's largest speed, rad²/s².
    most: f64,
}

impl SmoothKnots {
    fn new(curve: &FlowCurve, direction: i8, max_rad_s: f64, acceleration_rad_s2: f64) -> Self {
        /// Distance of a look on the other side of a knot, rad. The flow jumps at full engagement, where a
        /// pulse begins, and the first knot holds for both sides of the jump.
        const BESIDE_RAD: f64 = 1e-9;
        let (from_rad, uneven_rad) = curve.uneven_part();
        let origin_rad = if direction < 0 { -(from_rad + uneven_rad) } else { from_rad };
        let sign = f64::from(direction);
        let part_rad = uneven_rad / PARTS as f64;
        let mut per_square = [[0.0; 16]; PARTS / 16];
        for (knot, slot) in per_square.as_flattened_mut().iter_mut().enumerate() {
            let angle_rad = sign * (origin_rad + knot as f64 * part_rad);
            let flow = curve.flow_ml_rad(angle_rad).max(curve.flow_ml_rad(angle_rad - BESIDE_RAD));
            // No speed makes a forward flow where the flow reverses: the rotor passes as fast as it may.
            *slot = if flow > 0.0 { 1.0 / (flow * flow) } else { f64::INFINITY };
        }
        Self {
            pitch_rad: curve.pitch_rad(),
            origin_rad,
            uneven_rad,
            per_square,
            rise: 2.0 * acceleration_rad_s2 * part_rad,
            most: max_rad_s * max_rad_s,
        }
    }

    /// Returns the largest function below (flow/q)², changed by a lift, and the motor's limit that is nowhere
    /// steeper than the acceleration allows.
    ///
    /// The sweeps go forward and backward, twice round each. Wherever the smallest bound is, the second round
    /// passes every knot after it.
    fn envelope(&self, flow_ml_s: f64, lift: Option<Lift>) -> Envelope {
        let square = flow_ml_s * flow_ml_s;
        let mut squares = self.per_square.map(|row| row.map(|part| square * part));
        if let Some(lift) = lift {
            let lows = self.lows(lift).map(|low| square * low);
            for (knot, value) in squares.as_flattened_mut().iter_mut().enumerate() {
                *value = lift.limit_at(knot, *value, lows, self.rise).unwrap_or(self.most);
            }
        }
        let all = squares.as_flattened_mut();
        all.iter_mut().for_each(|value| *value = value.min(self.most));
        let mut before = f64::INFINITY;
        let mut sweep = |square: &mut f64| {
            *square = square.min(before + self.rise);
            before = *square;
        };
        for _ in 0..2 {
            all.iter_mut().for_each(&mut sweep);
        }
        let mut before = f64::INFINITY;
        let mut sweep = |square: &mut f64| {
            *square = square.min(before + self.rise);
            before = *square;
        };
        for _ in 0..2 {
            all.iter_mut().rev().for_each(&mut sweep);
        }
        Envelope::new(self.pitch_rad, self.uneven_rad, &squares)
    }
}

/// Returns the envelope of a flow limit for a motion, and the angle in it at which the motion starts, rad.
pub(super) fn envelope(curve: &FlowCurve, course: &Course, limit: &SmoothLimit) -> (Envelope, f64) {
    let knots = SmoothKnots::new(curve, course.direction, limit.max_rad_s, course.acceleration_rad_s2);
    let along_rad = f64::from(course.direction) * course.start_rad;
    let phase_rad = wrap(along_rad - knots.origin_rad, curve.pitch_rad());
    (knots.envelope(limit.flow_ml_s, limit.lift), phase_rad)
}

impl SmoothLimit {
    /// Finds the flow limit whose envelope has the mean speed `mean_rad_s`, at most `max_rad_s`, with the
    /// lift by which the flow at the end of the outlet line is most even.
    pub(in crate::plan) fn new(
        pump: &Pump,
        direction: i8,
        mean_rad_s: f64,
        max_rad_s: f64,
        acceleration_rad_s2: f64,
    ) -> Self {
        let curve = pump.outlet_curve();
        let knots = SmoothKnots::new(curve, direction, max_rad_s, acceleration_rad_s2);
        let plain_ml_s = knots.flow_limit_ml_s(curve, mean_rad_s, None);
        // The search for a lift compares flows of one direction.
        let swing =
            if curve.reverses() { None } else { Swing::new(pump.outlet(), curve.pitch_rad() / mean_rad_s) };
        let lift = swing.and_then(|swing| knots.search(swing, mean_rad_s).best(plain_ml_s as f32));
        let flow_ml_s = lift.map_or(plain_ml_s, |_| knots.flow_limit_ml_s(curve, mean_rad_s, lift));
        Self { flow_ml_s, max_rad_s, lift }
    }
}

impl SmoothKnots {
    /// Returns the inverse squares of the flow per radian at the knots in single precision.
    fn per_square(&self) -> [[f32; 16]; PARTS / 16] {
        self.per_square.map(|row| row.map(|part| part as f32))
    }

    /// Returns the factors of the square of the flow limit at the feet of a lift.
    fn lows(&self, lift: Lift) -> [f64; 2] {
        lift.lows(self.per_square().as_flattened()).map(f64::from)
    }

    /// Returns the search for the lift at a mean speed.
    fn search(&self, swing: Swing, mean_rad_s: f64) -> Search {
        let per_square = self.per_square();
        Search {
            swing,
            per_square,
            per_flow: per_square.map(|row| row.map(sqrtf)),
            part_rad: (self.uneven_rad / PARTS as f64) as f32,
            even_rad: (self.pitch_rad - self.uneven_rad) as f32,
            rise: self.rise as f32,
            most: self.most as f32,
            period_s: (self.pitch_rad / mean_rad_s) as f32,
        }
    }

    /// Finds the flow limit, mL/s, whose envelope has the mean speed `mean_rad_s`, at most the motor's.
    ///
    /// The mean rises with the limit, up to constant speed. The limit is a root in a bracket, found by regula
    /// falsi after Dowell and Jarratt ("Illinois", BIT 11:168, 1971).
    fn flow_limit_ml_s(&self, curve: &FlowCurve, mean_rad_s: f64, lift: Option<Lift>) -> f64 {
        let missing = |flow_ml_s| self.envelope(flow_ml_s, lift).mean_rad_s() / mean_rad_s - 1.0;
        let flow_ml_s = mean_rad_s * curve.pitch_ml() / curve.pitch_rad();
        // A limit of half the mean flow is too low. With the largest flow of the fastest motor the speed is
        // constant, also at the feet of a lift.
        let (_, largest_ml_rad) = curve.flow_range_ml_rad();
        let even = 1.0 / (largest_ml_rad * largest_ml_rad);
        let lowest = lift.map_or(even, |lift| self.lows(lift).into_iter().fold(even, f64::min));
        let most_ml_s = sqrt(self.most / lowest);
        let (mut low, mut high) = (0.5 * flow_ml_s, (1.1 * flow_ml_s).min(most_ml_s));
        let (mut below, mut above) = (missing(low), missing(high));
        // A lift over most of a pitch needs a lower limit.
        for _ in 0..60 {
            if below <= 0.0 {
                break;
            }
            low *= 0.5;
            below = missing(low);
        }
        while above < 0.0 {
            if high >= most_ml_s {
                return high;
            }
            (low, below) = (high, above);
            high = (1.5 * high).min(most_ml_s);
            above = missing(high);
        }
        let mut last = 0.0;
        for _ in 0..100 {
            let middle = (low * above - high * below) / (above - below);
            let found = missing(middle);
            if found.abs() < 1e-12 || high - low < 1e-15 * high {
                return middle;
            }
            // An end that stays a second time counts half.
            let stays = if found * last > 0.0 { 0.5 } else { 1.0 };
            if found < 0.0 {
                (low, below) = (middle, found);
                above *= stays;
            } else {
                (high, above) = (middle, found);
                below *= stays;
            }
            last = found;
        }
        0.5 * (low + high)
    }
}
