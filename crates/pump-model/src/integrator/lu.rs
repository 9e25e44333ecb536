//! LU factorisation with partial pivoting of a small matrix of fixed size.

use nalgebra::{SMatrix, SVector};

use super::complex::Entry;

/// Factorisation P A = L U, with the reciprocals of U's diagonal on the diagonal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lu<T, const N: usize> {
    factors: SMatrix<T, N, N>,
    pivots: [usize; N],
}

impl<T: Entry, const N: usize> Lu<T, N> {
    /// Factors `matrix`. Returns none if it is singular or not finite.
    pub(super) fn new(matrix: SMatrix<T, N, N>) -> Option<Self> {
        let mut factors = matrix;
        let mut pivots = [0; N];
        for column in 0..N {
            let mut pivot = column;
            for row in column + 1..N {
                if factors[(row, column)].size() > factors[(pivot, column)].size() {
                    pivot = row;
                }
            }
            let diagonal = factors[(pivot, column)];
            if !diagonal.size().is_finite() || diagonal.size() == 0.0 {
                return None;
            }
            pivots[column] = pivot;
            if pivot != column {
                for k in 0..N {
                    let swapped = factors[(column, k)];
                    factors[(column, k)] = factors[(pivot, k)];
                    factors[(pivot, k)] = swapped;
                }
            }
            let reciprocal = diagonal.reciprocal();
            factors[(column, column)] = reciprocal;
            for row in column + 1..N {
                let factor = factors[(row, column)] * reciprocal;
                factors[(row, column)] = factor;
                for k in column + 1..N {
                    let change = factor * factors[(column, k)];
                    factors[(row, k)] = factors[(row, k)] - change;
                }
            }
        }
        Some(Self { factors, pivots })
    }

    /// Returns the solution x of A x = b.
    pub(super) fn solve(&self, b: SVector<T, N>) -> SVector<T, N> {
        let mut x = b;
        for row in 0..N {
            let pivot = self.pivots[row];
            let swapped = x[row];
            x[row] = x[pivot];
            x[pivot] = swapped;
        }
        for row in 0..N {
            for k in 0..row {
                x[row] = x[row] - self.factors[(row, k)] * x[k];
            }
        }
        for row in (0..N).rev() {
            for k in row + 1..N {
                x[row] = x[row] - self.factors[(row, k)] * x[k];
            }
            x[row] = x[row] * self.factors[(row, row)];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::complex::Complex;

    #[test]
    fn a_system_that_needs_pivoting_is_solved() {
        let a = SMatrix::<f64, 3, 3>::new(0.0, 2.0, 1.0, 1.0, 1.0, 0.0, 3.0, 0.0, -1.0);
        let x = SVector::<f64, 3>::new(1.0, -2.0, 3.0);
        let solved = Lu::new(a).unwrap().solve(a * x);
        assert!((solved - x).amax() < 1e-14);
        assert!(Lu::new(SMatrix::<f64, 2, 2>::new(1.0, 2.0, 2.0, 4.0)).is_none());
        assert!(Lu::new(SMatrix::<f64, 1, 1>::new(f64::NAN)).is_none());
    }

    #[test]
    fn a_complex_system_that_needs_pivoting_is_solved() {
        let of = |re: f64, im: f64| Complex { re, im };
        let a = SMatrix::<Complex, 2, 2>::new(of(0.0, 0.0), of(1.0, 2.0), of(3.0, -1.0), of(0.0, 4.0));
        // The solution is (1 + i, 2 - i).
        let b = SVector::<Complex, 2>::new(of(4.0, 3.0), of(8.0, 10.0));
        let x = Lu::new(a).unwrap().solve(b);
        assert!((x[0] - of(1.0, 1.0)).size() < 1e-14 && (x[1] - of(2.0, -1.0)).size() < 1e-14, "{x:?}");
        let singular = SMatrix::<Complex, 1, 1>::new(of(0.0, f64::INFINITY));
        assert!(Lu::new(singular).is_none());
    }
}
