//! Linear least squares, row by row.

use libm::sqrt;

/// A column this small beside what it was is a combination of the others.
const SINGULAR: f64 = 1e-11;

/// R and Q^T b of all rows J x = b so far, by Givens rotations (Golub and Van Loan, "Matrix Computations",
/// 4th edition, 5.2.5): no row is kept, and nothing is squared as in normal equations.
#[derive(Debug, Clone, Copy)]
pub struct Triangle<const N: usize> {
    r: [[f64; N]; N],
    right: [f64; N],
    /// Sum of squares that no x explains.
    left: f64,
}

impl<const N: usize> Default for Triangle<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Triangle<N> {
    /// Returns a triangle of no rows, with every x free.
    pub fn new() -> Self {
        Self { r: [[0.0; N]; N], right: [0.0; N], left: 0.0 }
    }

    /// Returns a triangle of no rows that holds x at 0 where `free` is false.
    pub fn holding(free: [bool; N]) -> Self {
        let mut triangle = Self::new();
        for (n, free) in free.into_iter().enumerate() {
            triangle.r[n][n] = if free { 0.0 } else { 1.0 };
        }
        triangle
    }

    /// Takes one more row. The row must be 0 in the columns of x that are held.
    pub fn push(&mut self, mut row: [f64; N], mut right: f64) {
        for k in 0..N {
            if row[k] == 0.0 {
                continue;
            }
            let diagonal = self.r[k][k];
            let length = sqrt(diagonal * diagonal + row[k] * row[k]);
            let (c, s) = (diagonal / length, row[k] / length);
            for (above, below) in self.r[k].iter_mut().zip(&mut row).skip(k) {
                (*above, *below) = (c * *above + s * *below, c * *below - s * *above);
            }
            (self.right[k], right) = (c * self.right[k] + s * right, c * right - s * self.right[k]);
        }
        self.left += right * right;
    }

    /// Returns the rows of the triangle with their right sides.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (&[f64; N], f64)> {
        self.r.iter().zip(self.right)
    }

    /// Returns the sum of squares that the best x leaves.
    pub fn left(&self) -> f64 {
        self.left
    }

    /// Returns the sum of squares by which the best x is better than 0.
    pub fn gained(&self) -> f64 {
        self.right.iter().map(|right| right * right).sum()
    }

    /// Returns the length of each column.
    pub fn lengths(&self) -> [f64; N] {
        core::array::from_fn(|n| sqrt((0..=n).map(|row| self.r[row][n] * self.r[row][n]).sum()))
    }

    /// Returns the index of the first column that is 0 or a combination of the columns before it.
    pub fn singular(&self) -> Option<usize> {
        let lengths = self.lengths();
        let is_regular = |n: usize| self.r[n][n].abs() > SINGULAR * lengths[n];
        // A column that is NaN is singular too.
        (0..N).find(|n| !is_regular(*n))
    }

    /// Returns the x with the least sum of squares, or `None` if it is not unique.
    pub fn solution(&self) -> Option<[f64; N]> {
        if self.singular().is_some() { None } else { Some(self.back(self.right)) }
    }

    /// Returns the diagonal of (J^T J)^-1, the variances of x where each row has variance 1, or `None` if x
    /// is not unique.
    pub fn variances(&self) -> Option<[f64; N]> {
        if self.singular().is_some() {
            return None;
        }
        let mut variances = [0.0; N];
        for n in 0..N {
            let column = self.back(core::array::from_fn(|row| if row == n { 1.0 } else { 0.0 }));
            for (variance, element) in variances.iter_mut().zip(column) {
                *variance += element * element;
            }
        }
        Some(variances)
    }

    /// Returns the covariances of the x whose right sides have variance 1, or `None` if the x is not unique:
    /// (R^T R)^-1, as R^-1 R^-T.
    pub fn covariances(&self) -> Option<[[f64; N]; N]> {
        if self.singular().is_some() {
            return None;
        }
        let mut covariances = [[0.0; N]; N];
        for n in 0..N {
            let column = self.back(core::array::from_fn(|row| if row == n { 1.0 } else { 0.0 }));
            for (row, one) in covariances.iter_mut().zip(column) {
                for (covariance, other) in row.iter_mut().zip(column) {
                    *covariance += one * other;
                }
            }
        }
        Some(covariances)
    }

    /// Returns x of R x = `right`.
    fn back(&self, right: [f64; N]) -> [f64; N] {
        let mut x = right;
        for row in (0..N).rev() {
            for n in row + 1..N {
                x[row] -= self.r[row][n] * x[n];
            }
            x[row] /= self.r[row][row];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_is_that_of_the_textbook() {
        // Anscombe's first set (American Statistician 27, 1973): 3.0001 + 0.5001 x; standard errors 1.1247
        // and 0.1179.
        let x = [10.0, 8.0, 13.0, 9.0, 11.0, 14.0, 6.0, 4.0, 12.0, 7.0, 5.0];
        let y = [8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68];
        let mut triangle = Triangle::new();
        for (x, y) in x.into_iter().zip(y) {
            triangle.push([1.0, x], y);
        }
        let [offset, slope] = triangle.solution().unwrap();
        assert!((offset - 3.0001).abs() < 5e-5 && (slope - 0.5001).abs() < 5e-5, "{offset} {slope}");
        let errors = triangle.variances().unwrap().map(|variance| sqrt(variance * triangle.left() / 9.0));
        assert!((errors[0] - 1.1247).abs() < 5e-5 && (errors[1] - 0.1179).abs() < 5e-5, "{errors:?}");
        // Offset and slope have the mean of x in common: cov = -mean var(slope).
        let covariances = triangle.covariances().unwrap();
        let variances = triangle.variances().unwrap();
        assert!((covariances[0][1] + 9.0 * variances[1]).abs() < 1e-14, "{covariances:?}");
        assert_eq!([covariances[0][0], covariances[1][1]], variances);
        let total: f64 = y.iter().map(|y| y * y).sum();
        assert!((triangle.gained() + triangle.left() - total).abs() < 1e-12);
    }

    #[test]
    fn what_is_held_stays_and_what_is_a_combination_is_found() {
        let mut triangle = Triangle::holding([true, false, true]);
        for n in 0..5 {
            let x = f64::from(n);
            triangle.push([1.0, 0.0, x], 2.0 - 3.0 * x);
        }
        let [offset, held, slope] = triangle.solution().unwrap();
        assert!((offset - 2.0).abs() < 1e-14 && held == 0.0 && (slope + 3.0).abs() < 1e-14);
        let mut twice = Triangle::new();
        for n in 0..5 {
            let x = f64::from(n);
            twice.push([1.0, x, 2.0 * x + 1.0], x);
        }
        assert_eq!((twice.singular(), twice.solution(), twice.variances()), (Some(2), None, None));
        assert_eq!(Triangle::<2>::new().singular(), Some(0));
    }
}
