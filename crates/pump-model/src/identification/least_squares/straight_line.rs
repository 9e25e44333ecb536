//! A straight line through weighted points, perhaps with an offset or a bend.

use libm::sqrt;

use super::super::estimate::Estimate;
use super::triangle::Triangle;

/// A line that rises by less is one of values that are all the same, but for rounding.
const FLAT: f64 = 1e-12;

/// Terms of a straight line that a fit seeks. A term that is not sought is 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Terms {
    /// The fit seeks the offset.
    pub offset: bool,
    /// The fit seeks the slope.
    pub slope: bool,
    /// The fit seeks the bend.
    pub bend: bool,
}

impl Terms {
    /// Returns the number of terms that are sought.
    pub fn count(self) -> usize {
        [self.offset, self.slope, self.bend].into_iter().filter(|is_sought| *is_sought).count()
    }
}

/// A term of a straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// Value of the term.
    pub value: f64,
    /// Variance of the value if each point has the variance of its standard error; 0 of a term that was not
    /// sought.
    pub variance: f64,
}

/// y = offset + slope (x - reference) + bend (x - reference)|x - reference|, fitted to weighted points.
///
/// ```
/// use pump_model::identification::least_squares::{StraightLine, Terms};
/// let points = [(1.0, 2.1, 0.1), (2.0, 3.9, 0.1), (3.0, 6.1, 0.1), (4.0, 7.9, 0.1)];
/// let terms = Terms { offset: true, slope: true, bend: false };
/// let line = StraightLine::about_mean(points.into_iter(), terms).unwrap();
/// assert!((line.reference - 2.5).abs() < 1e-12 && (line.offset.value - 5.0).abs() < 1e-12);
/// assert!((line.slope.value - 1.96).abs() < 1e-12 && (line.at(3.0) - 5.98).abs() < 1e-12);
/// // 0.1²/4 and 0.1²/(1.5² + 0.5² + 0.5² + 1.5²)
/// assert!((line.offset.variance - 0.0025).abs() < 1e-12 && (line.slope.variance - 0.002).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StraightLine {
    /// Value of x from which the terms count.
    pub reference: f64,
    /// Offset: y at the reference.
    pub offset: Term,
    /// Slope at the reference.
    pub slope: Term,
    /// Bend.
    pub bend: Term,
    /// Sum of squares that the line leaves, each over the square of the point's standard error.
    pub left: f64,
    /// Number of points less number of terms, at least 0.
    pub degrees_of_freedom: u32,
    /// Rise from the reference to the point farthest from it, over the largest |y|.
    rise: f64,
}

impl StraightLine {
    /// Fits a line to points (x, y, standard error of y), with the terms counted from `reference`. Returns
    /// `None` if the points do not determine the terms.
    pub fn about(
        reference: f64,
        points: impl Iterator<Item = (f64, f64, f64)>,
        terms: Terms,
    ) -> Option<Self> {
        let mut triangle = Triangle::holding([terms.offset, terms.slope, terms.bend]);
        let (mut count, mut most_x, mut most_y) = (0_u32, 0.0_f64, 0.0_f64);
        for (x, y, error) in points {
            let x = x - reference;
            let only = |is_sought: bool, value: f64| if is_sought { value / error } else { 0.0 };
            let row = [only(terms.offset, 1.0), only(terms.slope, x), only(terms.bend, x * x.abs())];
            triangle.push(row, y / error);
            count += 1;
            (most_x, most_y) = (most_x.max(x.abs()), most_y.max(y.abs()));
        }
        let (values, variances) = (triangle.solution()?, triangle.variances()?);
        let term = |n: usize, is_sought: bool| Term {
            value: values[n],
            variance: if is_sought { variances[n] } else { 0.0 },
        };
        Some(Self {
            reference,
            offset: term(0, terms.offset),
            slope: term(1, terms.slope),
            bend: term(2, terms.bend),
            left: triangle.left(),
            degrees_of_freedom: count.saturating_sub(terms.count() as u32),
            rise: values[1] * most_x / most_y,
        })
    }

    /// Fits a line with the terms counted from the weighted mean of x, where offset and slope are
    /// independent. Returns `None` if the points do not determine the terms.
    pub fn about_mean(points: impl Iterator<Item = (f64, f64, f64)> + Clone, terms: Terms) -> Option<Self> {
        let (mut weights, mut moments) = (0.0, 0.0);
        for (x, _, error) in points.clone() {
            let weight = 1.0 / (error * error);
            weights += weight;
            moments += weight * x;
        }
        Self::about(moments / weights, points, terms)
    }

    /// Returns y of the line at `x`.
    pub fn at(&self, x: f64) -> f64 {
        let x = x - self.reference;
        self.offset.value + self.slope.value * x + self.bend.value * (x * x.abs())
    }

    /// Returns the terms with uncertainties from the scatter of the points: the ratios of their standard
    /// errors count, and their size follows from the scatter. Returns `None` without degrees of freedom.
    pub fn estimated(&self) -> Option<EstimatedLine> {
        if self.degrees_of_freedom == 0 {
            return None;
        }
        let square = self.left / f64::from(self.degrees_of_freedom);
        let of = |term: Term| Estimate::new(term.value, square * term.variance, self.degrees_of_freedom);
        Some(EstimatedLine {
            offset: of(self.offset),
            slope: of(self.slope),
            bend: of(self.bend),
            scatter: sqrt(square),
            rise: self.rise,
        })
    }
}

/// A straight line whose uncertainties follow from the scatter of its points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedLine {
    /// Offset: y at the reference.
    pub offset: Estimate,
    /// Slope at the reference.
    pub slope: Estimate,
    /// Bend.
    pub bend: Estimate,
    /// Root of the weighted mean square of the residuals over the degrees of freedom, in units of the points'
    /// errors.
    pub scatter: f64,
    /// Rise from the reference to the point farthest from it, over the largest |y|.
    rise: f64,
}

impl EstimatedLine {
    /// True if the line rises by more than rounding.
    pub fn is_rising(&self) -> bool {
        self.rise > FLAT
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_about_the_mean_is_the_line_about_zero() {
        let points = [(10.0, 1.02, 0.01), (20.0, 1.01, 0.02), (50.0, 0.99, 0.01), (100.0, 0.93, 0.03)];
        let terms = Terms { offset: true, slope: true, bend: false };
        let centred = StraightLine::about_mean(points.into_iter(), terms).unwrap();
        let zero = StraightLine::about(0.0, points.into_iter(), terms).unwrap();
        for x in [0.0, 33.0, 120.0] {
            assert!((centred.at(x) - zero.at(x)).abs() < 1e-12, "{x}");
        }
        assert!((centred.left - zero.left).abs() < 1e-9 && centred.degrees_of_freedom == 2);
        let weights: f64 = points.iter().map(|(_, _, error)| 1.0 / (error * error)).sum();
        assert!((centred.offset.variance * weights - 1.0).abs() < 1e-12);
    }

    #[test]
    fn points_that_do_not_determine_a_line_give_none() {
        let through = |points: &[(f64, f64, f64)], slope| {
            let terms = Terms { offset: true, slope, bend: false };
            StraightLine::about_mean(points.iter().copied(), terms)
        };
        assert_eq!(through(&[], false), None);
        assert_eq!(through(&[(3.0, 1.0, 0.1), (3.0, 1.1, 0.1)], true), None);
        let mean = through(&[(3.0, 1.0, 0.1)], false).unwrap();
        assert_eq!((mean.slope, mean.degrees_of_freedom), (Term { value: 0.0, variance: 0.0 }, 0));
        assert_eq!(mean.estimated(), None);
    }
}
