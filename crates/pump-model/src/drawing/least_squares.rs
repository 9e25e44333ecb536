//! The polynomial of degree five through points, by least squares.

use crate::math::polynomial::{DEGREE, Polynomial};

/// Fits y over x. There must be more than five different x.
///
/// The fit uses polynomials that are orthogonal on the points, made by their three-term recurrence. No system
/// is solved, so the near-dependence of the powers of x loses no digits. Source: Forsythe, "Generation and
/// use of orthogonal polynomials for data-fitting with a digital computer", J. SIAM 5, 1957.
pub(crate) fn quintic(points: impl Iterator<Item = (f64, f64)> + Clone) -> Polynomial {
    let mut fit = Polynomial::default();
    // The polynomials p_n and p_(n-1), and the squared length of the latter.
    let (mut basis, mut last) = (Polynomial::constant(1.0), Polynomial::default());
    let mut last_square = f64::INFINITY;
    for _ in 0..=DEGREE {
        let (mut square, mut moment, mut product) = (0.0, 0.0, 0.0);
        for (x, y) in points.clone() {
            let value = basis.at(x);
            square += value * value;
            moment += x * value * value;
            // The part not fitted yet serves as well as y itself, except for rounding.
            product += (y - fit.at(x)) * value;
        }
        fit = fit.plus(&basis.scaled(product / square));
        let shift = moment / square;
        let next = times_x(&basis).plus(&basis.scaled(-shift)).plus(&last.scaled(-square / last_square));
        (last, basis, last_square) = (basis, next, square);
    }
    fit
}

/// Returns x p(x) without its highest order. Only the last basis has that order, and it is not used.
fn times_x(p: &Polynomial) -> Polynomial {
    let [c0, c1, c2, c3, c4, _] = p.c;
    Polynomial { c: [0.0, c0, c1, c2, c3, c4] }
}
