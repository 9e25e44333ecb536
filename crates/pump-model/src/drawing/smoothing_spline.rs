//! Cubic splines near more points than they have knots, by least squares.
//!
//! Source: de Boor, "A Practical Guide to Splines", revised edition, Springer 2001: B-splines in chapter X, least
//! squares in chapter XIV. Rotations stand here in place of its normal equations, so nothing is squared. B-splines add
//! to 1 and are nearly independent at any scale of the angle.

use core::array::from_fn;

use libm::{fabs, sqrt};

use super::monotone_spline::{Knot, Knots, MAX_KNOTS};

/// Number of B-splines of order 4 over this many knots.
const MAX_COEFFICIENTS: usize = MAX_KNOTS + 2;

/// Returns values and slopes, at its knots, of the cubic spline with the least sum of squares.
///
/// `points` (rad, mL) reach from 0 to `end_rad`, in any order. The spline is 0 at 0, and its slope is 0 at both ends.
pub(super) fn knots(points: impl Iterator<Item = (f64, f64)> + Clone, end_rad: f64) -> Knots {
    let places = Places::of(points.clone().map(|(x, _)| x), end_rad);
    let mut system = Banded::default();
    let mut weights = [0.0; MAX_KNOTS];
    for (x, volume_ml) in points {
        let piece = places.piece_at(x);
        let [b0, b1, b2, b3] = basis::<4>(&places.around(piece), x);
        // The first two coefficients are 0, as value and slope are there. The last two are equal: slope 0.
        let [b2, b3] = if piece + 2 == places.count { [b2 + b3, 0.0] } else { [b2, b3] };
        system.push(
            piece,
            match piece {
                0 => [0.0, 0.0, b2, b3],
                1 => [0.0, b1, b2, b3],
                _ => [b0, b1, b2, b3],
            },
            volume_ml,
        );
        weights[piece] += 1.0;
        weights[piece + 1] += 1.0;
    }
    let mut coefficients = system.solution();
    coefficients[places.count + 1] = coefficients[places.count];
    Knots::fitted((0..places.count).map(|n| {
        let x_rad = places.x[n];
        let piece = n.min(places.count - 2);
        let around = places.around(piece);
        let c: [f64; 4] = from_fn(|i| coefficients[piece + i]);
        let steps: [f64; 3] = from_fn(|i| 3.0 * (c[i + 1] - c[i]) / (around[i + 3] - around[i]));
        let sum = |basis: &[f64], c: &[f64]| basis.iter().zip(c).map(|(b, c)| b * c).sum();
        Knot {
            x_rad,
            volume_ml: sum(&basis::<4>(&around, x_rad), &c),
            weight: weights[n],
            slope_ml_rad: sum(&basis::<3>(&around, x_rad), &steps),
        }
    }))
}

/// Places of the knots, rad, from 0 to the largest angle. There are two at least.
struct Places {
    x: [f64; MAX_KNOTS],
    count: usize,
}

impl Places {
    /// Chooses the angles next to even divisions of 0 to `end_rad`.
    ///
    /// A division without an angle within half a division has no knot, nor has one less than half a division behind
    /// the knot before. As there is a point at every knot, one spline is the best (Schoenberg and Whitney, in
    /// chapter XIII). Quantiles of the angles would crowd the knots where most points are, and follow their scatter.
    fn of(angles: impl Iterator<Item = f64> + Clone, end_rad: f64) -> Self {
        let mut places = Self { x: [0.0; MAX_KNOTS], count: 1 };
        let division = end_rad / (MAX_KNOTS - 1) as f64;
        let mut last = 0.0;
        for n in 1..MAX_KNOTS - 1 {
            let ideal = n as f64 * division;
            let nearer = |one: f64, other: f64| {
                let (near, far) = (fabs(one - ideal), fabs(other - ideal));
                if near < far || near == far && one < other { one } else { other }
            };
            let x = angles.clone().fold(f64::INFINITY, nearer);
            if fabs(x - ideal) <= 0.5 * division && x - last >= 0.5 * division {
                places.x[places.count] = x;
                places.count += 1;
                last = x;
            }
        }
        places.x[places.count] = end_rad;
        places.count += 1;
        places
    }

    /// Returns the number of the piece that holds `x`, which must lie between the ends.
    fn piece_at(&self, x: f64) -> usize {
        self.x.iter().take(self.count - 1).skip(1).filter(|place| **place <= x).count()
    }

    /// Returns the three knots up to the start of a piece and the three from its end on. The first and the last knot
    /// stand there more than once.
    fn around(&self, piece: usize) -> [f64; 6] {
        from_fn(|n| self.x[(piece + n).saturating_sub(2).min(self.count - 1)])
    }
}

/// Returns the B-splines of this order, 4 at most, that are not 0 at `x` between the middle two of the knots.
fn basis<const ORDER: usize>(around: &[f64; 6], x: f64) -> [f64; ORDER] {
    let mut values = [0.0; ORDER];
    values[0] = 1.0;
    for order in 1..ORDER {
        let mut saved = 0.0;
        for n in 0..order {
            let (right, left) = (around[3 + n] - x, x - around[3 + n - order]);
            let part = values[n] / (right + left);
            values[n] = saved + right * part;
            saved = left * part;
        }
        values[order] = saved;
    }
    values
}

/// R and Q^T b of all rows J x = b so far, by Givens rotations. Each row has four neighbours that are not 0, and so
/// has what a rotation leaves of it, one column further.
struct Banded {
    /// The diagonal, and the three elements behind it.
    rows: [[f64; 4]; MAX_COEFFICIENTS],
    right: [f64; MAX_COEFFICIENTS],
}

impl Default for Banded {
    fn default() -> Self {
        Self { rows: [[0.0; 4]; MAX_COEFFICIENTS], right: [0.0; MAX_COEFFICIENTS] }
    }
}

impl Banded {
    /// Takes one more row, whose first element stands in column `first`.
    fn push(&mut self, first: usize, mut row: [f64; 4], mut right: f64) {
        for (upper, upper_right) in self.rows.iter_mut().zip(&mut self.right).skip(first) {
            let length = sqrt(upper[0] * upper[0] + row[0] * row[0]);
            if row[0] != 0.0 {
                let (c, s) = (upper[0] / length, row[0] / length);
                for (above, below) in upper.iter_mut().zip(&mut row) {
                    (*above, *below) = (c * *above + s * *below, c * *below - s * *above);
                }
                (*upper_right, right) = (c * *upper_right + s * right, c * right - s * *upper_right);
            }
            row = [row[1], row[2], row[3], 0.0];
        }
    }

    /// Returns the best x, with 0 for columns that no row has.
    fn solution(&self) -> [f64; MAX_COEFFICIENTS] {
        let mut x = [0.0; MAX_COEFFICIENTS];
        let mut behind = [0.0; 3];
        for ((row, right), x) in self.rows.iter().zip(self.right).zip(&mut x).rev() {
            let known: f64 = row.iter().skip(1).zip(behind).map(|(r, x)| r * x).sum();
            if row[0] != 0.0 {
                *x = (right - known) / row[0];
            }
            behind = [*x, behind[0], behind[1]];
        }
        x
    }
}
