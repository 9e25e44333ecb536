//! The choice of the lift that makes the flow at the line's end most even.

use libm::sqrtf;

use super::envelope::PARTS;
use super::lift::Lift;
use super::swing::Swing;

/// A number for each knot, in rows of 16.
type PerKnot = [[f32; 16]; PARTS / 16];

/// Part of the ripple without a lift that a lift must undercut. A lift strains the motor, so it must be worth it.
const WORTH: f32 = 0.9;

/// Part of the flow by which a lift must make the ripple less. Less than that is within the error of linear
/// flows between knots, and of the jump where a pulse begins.
const LEAST: f32 = 0.02;

/// Part by which a start must change the ripple. A lift inside the motor's own ramps changes nothing, and a
/// search from there finds nothing.
const TELLING: f32 = 0.05;

/// Distances of both feet from the pulse's middle at which the search starts, as parts of the distances of the
/// pulse's ends.
///
/// On the paper's pump the searches from them end near what a linear program over all knots finds at 8, 15 and
/// 30 mL/s.
const DISTANCES: [[f32; 2]; 6] =
    [[0.3, 0.3], [0.45, 0.6], [0.6, 0.75], [0.75, 0.75], [0.9, 0.9], [0.85, 0.45]];

/// Parts by which the limit is lower at the feet at which the search starts.
const LOWER: [f32; 2] = [0.15, 0.45];

/// First step of the search, and the step at which it ends, in knots.
const FIRST: f32 = 2.0;
const LAST: f32 = 0.2;

/// The knots of a smooth flow in single precision, as a search needs them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Search {
    pub(super) swing: Swing,
    /// Inverse square of the flow per radian at each knot, rad²/mL², and its root.
    pub(super) per_square: PerKnot,
    pub(super) per_flow: PerKnot,
    /// Length of a part between two knots, and of the even part, rad.
    pub(super) part_rad: f32,
    pub(super) even_rad: f32,
    /// Largest change of the square of the speed from knot to knot, and its largest value, rad²/s².
    pub(super) rise: f32,
    pub(super) most: f32,
    /// Time of a pitch, s.
    pub(super) period_s: f32,
}

/// A lift with its flow limit and the largest less the smallest flow at the line's end, both mL/s.
#[derive(Debug, Clone, Copy)]
struct Trial {
    lift: Option<Lift>,
    flow_ml_s: f32,
    peak_to_peak: f32,
}

impl Search {
    /// Returns the lift whose flow at the line's end has the least ripple peak to peak, or no lift if that
    /// is worth it. The flow limit without a lift is near `flow_ml_s`.
    ///
    /// The search goes from the best start along one number at a time, by steps that it halves where no step
    /// is better (Hooke and Jeeves, J. ACM 8:212, 1961, without their pattern moves).
    pub(super) fn best(&self, flow_ml_s: f32) -> Option<Lift> {
        if self.is_even(flow_ml_s) {
            return None;
        }
        let plain = self.trial(None, flow_ml_s, f32::INFINITY)?;
        let middle = self.middle();
        let none = Trial { peak_to_peak: f32::INFINITY, ..plain };
        let starts = DISTANCES.iter().flat_map(|feet| LOWER.map(|lower| started(*feet, lower, middle)));
        let tells = |found: &Trial| (found.peak_to_peak / plain.peak_to_peak - 1.0).abs() > TELLING;
        let mut best = starts.fold(none, |best, lift| {
            let found = self.better(best, lift, middle);
            if tells(&found) { found } else { best }
        });
        let mut step = FIRST;
        while step > LAST {
            let before = best.peak_to_peak;
            for number in 0..4 {
                let from = best.lift?;
                let up = self.better(best, moved(from, number, step), middle);
                let is_better = up.peak_to_peak < best.peak_to_peak;
                best = if is_better { up } else { self.better(best, moved(from, number, -step), middle) };
            }
            if best.peak_to_peak >= before {
                step *= 0.5;
            }
        }
        let worth = (WORTH * plain.peak_to_peak).min(plain.peak_to_peak - LEAST * flow_ml_s);
        best.lift.filter(|_| best.peak_to_peak < worth)
    }

    /// Returns the better of a trial and another lift.
    fn better(&self, best: Trial, lift: Lift, middle: usize) -> Trial {
        let found = lift.is_about(middle).then(|| self.trial(Some(lift), best.flow_ml_s, best.peak_to_peak));
        let found = found.flatten();
        found.filter(|found| found.peak_to_peak < best.peak_to_peak).unwrap_or(best)
    }

    /// Returns the number of the knot with the least flow per radian.
    fn middle(&self) -> usize {
        let most = self.per_square.as_flattened().iter().copied().fold(0.0, f32::max);
        self.per_square.as_flattened().iter().position(|part| *part >= most).unwrap_or(0)
    }

    /// Returns true if the motor follows every pulse at a flow limit.
    fn is_even(&self, flow_ml_s: f32) -> bool {
        /// Part by which a square may differ.
        const SAME: f32 = 1e-3;
        let squares = self.squares(flow_ml_s, None);
        let wanted = self.per_square.as_flattened().iter().map(|part| flow_ml_s * flow_ml_s * part);
        squares.as_flattened().iter().zip(wanted).all(|(square, wanted)| *square >= (1.0 - SAME) * wanted)
    }

    /// Tries a lift. There is no trial where no flow limit near `flow_ml_s` gives the mean speed, or where the ripple
    /// exceeds `most`, mL/s.
    fn trial(&self, lift: Option<Lift>, flow_ml_s: f32, most: f32) -> Option<Trial> {
        /// Largest part by which the time of a pitch may differ.
        const NEAR: f32 = 3e-4;
        let mut flow_ml_s = flow_ml_s;
        let mut last: Option<(f32, f32)> = None;
        for _ in 0..8 {
            let speeds = self.squares(flow_ml_s, lift).map(|row| row.map(sqrtf));
            let parts = self.parts(&speeds);
            let off = parts.clone().map(|(duration_s, ..)| duration_s).sum::<f32>() / self.period_s - 1.0;
            if off.abs() < NEAR {
                let peak_to_peak = self.swing.outflow(parts, most)?.peak_to_peak();
                return Some(Trial { lift, flow_ml_s, peak_to_peak });
            }
            // A secant; at first, and where it leads astray, in proportion.
            let rise = match last {
                Some((flow, before)) if off != before => -off * (flow_ml_s - flow) / (off - before),
                _ => off * flow_ml_s,
            };
            last = Some((flow_ml_s, off));
            // `clamp` would panic if the flow were not a number.
            flow_ml_s += rise.max(-0.3 * flow_ml_s).min(0.5 * flow_ml_s);
        }
        None
    }

    /// Returns the largest squares of the speed below the limits that are nowhere steeper than the
    /// acceleration allows, as `smooth.rs` does.
    fn squares(&self, flow_ml_s: f32, lift: Option<Lift>) -> PerKnot {
        let square = flow_ml_s * flow_ml_s;
        let mut squares = self.per_square.map(|row| row.map(|part| square * part));
        if let Some(lift) = lift {
            let lows = lift.lows(self.per_square.as_flattened()).map(|low| square * low);
            for (knot, value) in squares.as_flattened_mut().iter_mut().enumerate() {
                *value = lift.limit_at(knot, *value, lows, self.rise).unwrap_or(self.most);
            }
        }
        let all = squares.as_flattened_mut();
        all.iter_mut().for_each(|value| *value = value.min(self.most));
        let mut before = f32::INFINITY;
        let mut sweep = |square: &mut f32| {
            *square = square.min(before + self.rise);
            before = *square;
        };
        for _ in 0..2 {
            all.iter_mut().for_each(&mut sweep);
        }
        let mut before = f32::INFINITY;
        let mut sweep = |square: &mut f32| {
            *square = square.min(before + self.rise);
            before = *square;
        };
        for _ in 0..2 {
            all.iter_mut().rev().for_each(&mut sweep);
        }
        squares
    }

    /// Returns the parts of a pitch: the duration, s, and the flows at the rollers at both ends, mL/s.
    fn parts<'a>(&'a self, speeds: &'a PerKnot) -> impl Iterator<Item = (f32, f32, f32)> + Clone + 'a {
        let [[first, ..], ..] = speeds;
        let [[even, ..], ..] = &self.per_flow;
        let knots = || speeds.as_flattened().iter().zip(self.per_flow.as_flattened()).chain([(first, even)]);
        let along = knots().zip(knots().skip(1)).map(|((from, from_part), (to, to_part))| {
            (2.0 * self.part_rad / (from + to), from / from_part, to / to_part)
        });
        let flow = first / even;
        along.chain([(self.even_rad / first, flow, flow)])
    }
}

/// Returns the lift of a start about the middle of the pulse.
fn started([before, after]: [f32; 2], lower: f32, middle: usize) -> Lift {
    let middle = middle as f32;
    let feet = [middle * (1.0 - before), middle + (PARTS as f32 - middle) * after];
    Lift { feet, lower: [lower; 2] }
}

/// Returns a lift with one of its four numbers moved: a foot by `step` knots, or the limit there by a part.
fn moved(lift: Lift, number: usize, step: f32) -> Lift {
    /// Part of the limit for a knot.
    const PART: f32 = 0.05;
    let Lift { feet: [first, last], lower: [one, two] } = lift;
    match number {
        0 => Lift { feet: [first + step, last], ..lift },
        1 => Lift { feet: [first, last + step], ..lift },
        2 => Lift { lower: [one + PART * step, two], ..lift },
        _ => Lift { lower: [one, two + PART * step], ..lift },
    }
}
