//! The lift: a part of the pulse in which the flow at the rollers may exceed the flow limit.

use core::ops::{Add, Mul};

use super::envelope::PARTS;

/// A part of the pulse in which the flow limit does not hold, between two feet at which a lower limit holds.
///
/// Where the motor cannot follow a pulse, the flow dips. A lift starts the acceleration earlier: the flow
/// falls at the first foot, rises above its mean, dips less, rises again, and falls at the second foot. The
/// rollers' flow is then less even. But it departs from its mean in quick turns, which the line evens out,
/// and not in one dip, which the line amplifies.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Lift {
    /// Places of the feet, in knots.
    pub(super) feet: [f32; 2],
    /// Part by which the flow limit is lower at each foot.
    pub(super) lower: [f32; 2],
}

impl Lift {
    /// Returns the factors of the square of the flow limit at the feet. `per_square` has the inverse squares
    /// of the flow per radian at the knots.
    pub(super) fn lows(&self, per_square: &[f32]) -> [f32; 2] {
        let [first, last] = self.feet;
        let [one, two] = self.lower;
        let at = |knot: usize| per_square.get(knot).or(per_square.first()).copied().unwrap_or(0.0);
        [(first, one), (last, two)].map(|(foot, lower)| {
            let knot = foot as usize;
            let part = foot - knot as f32;
            (1.0 - lower) * (1.0 - lower) * (at(knot) + part * (at(knot + 1) - at(knot)))
        })
    }

    /// Returns the limit of the square of the speed at a knot, or none between the feet. `limit` is the flow
    /// limit's, `lows` are the limits at the feet, and `rise` is the largest change from knot to knot.
    pub(super) fn limit_at<T>(&self, knot: usize, limit: T, lows: [T; 2], rise: T) -> Option<T>
    where
        T: Copy + PartialOrd + From<f32> + Add<Output = T> + Mul<Output = T>,
    {
        let [first, last] = self.feet;
        let place = knot as f32;
        let is_between = first < place && place < last;
        [(first, lows[0]), (last, lows[1])]
            .into_iter()
            .filter(|(foot, _)| (place - foot).abs() < 1.0)
            .map(|(foot, low)| low + rise * T::from((place - foot).abs()))
            .chain((!is_between).then_some(limit))
            .reduce(|one, other| if other < one { other } else { one })
    }

    /// Returns true if the feet lie on either side of the knot `middle`, and both limits are positive.
    pub(super) fn is_about(&self, middle: usize) -> bool {
        /// Largest part by which a limit is lower.
        const LOWEST: f32 = 0.85;
        let [first, last] = self.feet;
        let middle = middle as f32;
        let are_beside = 0.0 <= first && first < middle - 1.0 && middle + 1.0 < last && last <= PARTS as f32;
        are_beside && self.lower.iter().all(|part| (0.0..=LOWEST).contains(part))
    }
}
