//! The bend of a displacement over the speed: what a parabola has beyond the line of the same runs.

use libm::sqrt;
use pump_model::identification::least_squares::StraightLine;
use pump_model::identification::widening;
use serde::{Deserialize, Serialize};

use super::points::Points;

/// Fewest speeds that may show a bend. Through three speeds every parabola fits, so nothing would show that it
/// is their shape.
const SPEEDS: usize = 4;

/// Number of parameters of a parabola.
const PARAMETERS: usize = 3;

/// Bend of a displacement over the speed: kappa has per_rpm2 (x² - skew x - spread) beyond the line, x the
/// speed less the line's reference.
///
/// That polynomial is orthogonal to 1 and x over the runs (Forsythe, J. SIAM 5, 1957). So factor and slope
/// stay those of the line, and the three estimates are independent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct SpeedBend {
    /// Bend, in min²/r².
    pub(crate) per_rpm2: f64,
    /// Standard error of the bend, in min²/r², from the scatter of the runs.
    pub(crate) standard_per_rpm2: f64,
    /// Weighted mean of x³ over that of x², in r/min.
    pub(crate) skew_rpm: f64,
    /// Weighted mean of x², in r²/min².
    pub(crate) spread_rpm2: f64,
}

impl SpeedBend {
    /// Returns the bend of the runs about their line if they ask for one: if an F test rejects the line against
    /// the parabola at 4.55 %, the level of the coverage factor 2.
    ///
    /// F is the sum of squares that the bend explains over the variance of the runs (Draper and Smith, "Applied
    /// Regression Analysis", 3rd edition, 6.1, the extra sum of squares). It has one degree of freedom above,
    /// so its root is compared with Student's t. The variance is that within the speeds, or that about the
    /// parabola where no speed was repeated.
    pub(super) fn asked_for(points: &Points, line: &StraightLine) -> Option<Self> {
        if points.speeds_rpm.len() < SPEEDS {
            return None;
        }
        let found = Self::least_squares(points, line)?;
        let departures = points
            .departures(points.weighted().map(|(rpm, ..)| line.at(rpm) + found.at(rpm - line.reference)));
        let variance = departures.variance_ratio(PARAMETERS)?;
        let standard_per_rpm2 = found.standard_per_rpm2 * sqrt(variance.ratio);
        let t = 2.0 * widening(variance.degrees_of_freedom.get());
        (found.per_rpm2.abs() > t * standard_per_rpm2).then_some(Self { standard_per_rpm2, ..found })
    }

    /// Returns the bend with the least sum of squares. Its standard error is the one that was expected.
    fn least_squares(points: &Points, line: &StraightLine) -> Option<Self> {
        let mut moments = [0.0; 4];
        for (rpm, _, weight) in points.weighted() {
            let x = rpm - line.reference;
            let mut power = weight;
            for moment in &mut moments {
                *moment += power;
                power *= x;
            }
        }
        let flat = Self {
            per_rpm2: 1.0,
            standard_per_rpm2: 0.0,
            skew_rpm: moments[3] / moments[2],
            spread_rpm2: moments[2] / moments[0],
        };
        let (mut product, mut square) = (0.0, 0.0);
        for (rpm, ratio, weight) in points.weighted() {
            let term = flat.at(rpm - line.reference);
            product += weight * term * (ratio - line.at(rpm));
            square += weight * term * term;
        }
        (square > 0.0).then(|| Self {
            per_rpm2: product / square,
            standard_per_rpm2: 1.0 / sqrt(square),
            ..flat
        })
    }

    /// Returns the bend of a line that is so many times as high.
    pub(super) fn times(self, level: f64) -> Self {
        let (per_rpm2, standard_per_rpm2) = (level * self.per_rpm2, level * self.standard_per_rpm2);
        Self { per_rpm2, standard_per_rpm2, ..self }
    }

    /// Returns what the bend adds to kappa at a speed less the reference, in r/min.
    pub(super) fn at(&self, x_rpm: f64) -> f64 {
        self.per_rpm2 * self.term_rpm2(x_rpm)
    }

    /// Returns the standard error that the bend adds to kappa at a speed less the reference, in r/min.
    pub(super) fn standard_at(&self, x_rpm: f64) -> f64 {
        self.standard_per_rpm2 * self.term_rpm2(x_rpm)
    }

    fn term_rpm2(&self, x_rpm: f64) -> f64 {
        x_rpm * (x_rpm - self.skew_rpm) - self.spread_rpm2
    }
}
