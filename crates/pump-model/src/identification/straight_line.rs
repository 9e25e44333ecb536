//! A straight line through points, perhaps with an offset or a bend.

use crate::math::sqrt;

use super::estimate::Estimate;
use super::triangle::Triangle;

/// y = offset + slope x + bend x|x|, of which some are sought.
#[derive(Debug, Clone, Copy)]
pub(super) struct StraightLine {
    pub(super) offset: Estimate,
    pub(super) slope: Estimate,
    pub(super) bend: Estimate,
    /// Root of the weighted mean square of the residuals over the degrees of freedom, in units of the points' errors.
    pub(super) scatter: f64,
    /// By how much it rises from 0 to the largest |x|, over the largest |y|.
    pub(super) rise: f64,
}

/// A line that rises by less is one of values that are all the same, but for rounding.
const FLAT: f64 = 1e-12;

/// Terms that are sought beside the slope.
#[derive(Debug, Clone, Copy)]
pub(super) struct Terms {
    pub(super) offset: bool,
    pub(super) bend: bool,
}

impl Terms {
    pub(super) fn count(self) -> usize {
        1 + usize::from(self.offset) + usize::from(self.bend)
    }
}

impl StraightLine {
    /// Through points (x, y, standard error of y); the errors' ratios count, their size follows from the scatter. None
    /// if the points do not determine it or are no more than the parameters.
    pub(super) fn through(points: impl Iterator<Item = (f64, f64, f64)>, terms: Terms) -> Option<Self> {
        let mut triangle = Triangle::holding([terms.offset, true, terms.bend]);
        let (mut count, mut most_x, mut most_y) = (0_u32, 0.0_f64, 0.0_f64);
        for (x, y, error) in points {
            let only = |is_sought: bool, value: f64| if is_sought { value / error } else { 0.0 };
            triangle.push([only(terms.offset, 1.0), x / error, only(terms.bend, x * x.abs())], y / error);
            count += 1;
            (most_x, most_y) = (most_x.max(x.abs()), most_y.max(y.abs()));
        }
        let degrees_of_freedom = count.checked_sub(terms.count() as u32).filter(|more| *more > 0)?;
        let (values, variances) = (triangle.solution()?, triangle.variances()?);
        let square = triangle.left() / f64::from(degrees_of_freedom);
        let [offset, slope, bend] =
            [0, 1, 2].map(|n| Estimate::new(values[n], square * variances[n], degrees_of_freedom));
        let rise = slope.value * most_x / most_y;
        Some(Self { offset, slope, bend, scatter: sqrt(square), rise })
    }

    /// True if the line rises by more than rounding.
    pub(super) fn is_rising(&self) -> bool {
        self.rise > FLAT
    }
}
