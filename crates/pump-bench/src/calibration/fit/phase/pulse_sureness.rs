//! How sure a pulse is. The demo in the browser compiles this file too, so it needs neither std nor this crate.

use libm::sqrt;

/// Joint uncertainty of a fitted pulse: covariances of V_r, as a part of it, of phi, in rad, and of the zero,
/// in rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PulseSureness {
    covariances: [[f64; 3]; 3],
}

impl PulseSureness {
    /// Returns the uncertainty with these covariances.
    pub(crate) fn new(covariances: [[f64; 3]; 3]) -> Self {
        Self { covariances }
    }

    /// Returns the uncertainty of a default pulse, whose covariances are those of V_r, as a part of it, and of phi, in
    /// rad, beside that of the zero, in rad.
    pub(crate) fn of_default(covariances: [[f64; 2]; 2], zero_standard_rad: f64) -> Self {
        let [[roller, both], [_, phi]] = covariances;
        let zero = zero_standard_rad * zero_standard_rad;
        Self { covariances: [[roller, both, 0.0], [both, phi, 0.0], [0.0, 0.0, zero]] }
    }

    /// Returns the errors of V_r, as a part of it, of phi, in rad, and of the zero, in rad, that three independent
    /// normal numbers make: the product of Cholesky's factor of the covariances with the numbers.
    pub(crate) fn errors(&self, normal: [f64; 3]) -> [f64; 3] {
        let mut factor = [[0.0; 3]; 3];
        for row in 0..3 {
            for column in 0..=row {
                let sum: f64 = (0..column).map(|n| factor[row][n] * factor[column][n]).sum();
                let left = self.covariances[row][column] - sum;
                factor[row][column] = match (row == column, factor[column][column]) {
                    (true, _) => sqrt(left.max(0.0)),
                    (false, 0.0) => 0.0,
                    (false, diagonal) => left / diagonal,
                };
            }
        }
        factor.map(|row| row.iter().zip(normal).map(|(entry, number)| entry * number).sum())
    }

    /// Returns the variance of a quantity whose derivatives by V_r (over V_r), phi and zero are `slopes`
    /// (GUM, JCGM 100:2008, equation 13).
    pub(crate) fn variance(&self, slopes: [f64; 3]) -> f64 {
        let sum = |row: &[f64; 3]| row.iter().zip(slopes).map(|(covariance, slope)| covariance * slope).sum();
        let variance: f64 =
            self.covariances.iter().map(sum).zip(slopes).map(|(sum, slope): (f64, f64)| sum * slope).sum();
        variance.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_have_the_covariances_of_the_fit() {
        let covariances = [[4.0, 1.0, -2.0], [1.0, 3.0, 0.5], [-2.0, 0.5, 5.0]];
        let sureness = PulseSureness::new(covariances);
        let columns =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|normal| sureness.errors(normal));
        for row in 0..3 {
            for other in 0..3 {
                let sum: f64 = columns.iter().map(|column| column[row] * column[other]).sum();
                assert!((sum - covariances[row][other]).abs() < 1e-12, "{row} {other}: {sum}");
            }
        }
    }
}
