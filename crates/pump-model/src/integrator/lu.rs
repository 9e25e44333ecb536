//! LU factorisation with partial pivoting of a small matrix of fixed size.

use nalgebra::{SMatrix, SVector};

/// Factorisation P A = L U, with the reciprocals of U's diagonal on the diagonal. One factorisation serves
/// eight solutions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lu<const N: usize> {
    factors: SMatrix<f64, N, N>,
    pivots: [usize; N],
}

impl<const N: usize> Lu<N> {
    /// Factors `matrix`. Returns none if it is singular or not finite.
    pub(super) fn new(matrix: SMatrix<f64, N, N>) -> Option<Self> {
        let mut factors = matrix;
        let mut pivots = [0; N];
        for column in 0..N {
            let mut pivot = column;
            for row in column + 1..N {
                if factors[(row, column)].abs() > factors[(pivot, column)].abs() {
                    pivot = row;
                }
            }
            let diagonal = factors[(pivot, column)];
            if !diagonal.is_finite() || diagonal == 0.0 {
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
            let reciprocal = 1.0 / diagonal;
            factors[(column, column)] = reciprocal;
            for row in column + 1..N {
                let factor = factors[(row, column)] * reciprocal;
                factors[(row, column)] = factor;
                for k in column + 1..N {
                    factors[(row, k)] -= factor * factors[(column, k)];
                }
            }
        }
        Some(Self { factors, pivots })
    }

    /// Returns the solution x of A x = b.
    pub(super) fn solve(&self, b: SVector<f64, N>) -> SVector<f64, N> {
        let mut x = b;
        for row in 0..N {
            let pivot = self.pivots[row];
            let swapped = x[row];
            x[row] = x[pivot];
            x[pivot] = swapped;
        }
        for row in 0..N {
            for k in 0..row {
                x[row] -= self.factors[(row, k)] * x[k];
            }
        }
        for row in (0..N).rev() {
            for k in row + 1..N {
                x[row] -= self.factors[(row, k)] * x[k];
            }
            x[row] *= self.factors[(row, row)];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_that_needs_pivoting_is_solved() {
        let a = SMatrix::<f64, 3, 3>::new(0.0, 2.0, 1.0, 1.0, 1.0, 0.0, 3.0, 0.0, -1.0);
        let x = SVector::<f64, 3>::new(1.0, -2.0, 3.0);
        let solved = Lu::new(a).unwrap().solve(a * x);
        assert!((solved - x).amax() < 1e-14);
        assert!(Lu::new(SMatrix::<f64, 2, 2>::new(1.0, 2.0, 2.0, 4.0)).is_none());
        assert!(Lu::new(SMatrix::<f64, 1, 1>::new(f64::NAN)).is_none());
    }
}
