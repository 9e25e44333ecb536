//! The solution between the ends of a step.

use nalgebra::SVector;

use crate::polynomial::Polynomial;

/// An accepted step, with the quintic Hermite polynomial through value, slope and curvature at both ends.
///
/// y'' = J f + f_t is exact along the solution, so the polynomial is of order six where the problem is not stiff.
#[derive(Debug, Clone, Copy)]
pub struct DenseStep<const N: usize> {
    /// When the step starts, s.
    pub start_s: f64,
    /// Its length, s.
    pub length_s: f64,
    /// Value at both ends.
    pub(crate) value: [SVector<f64, N>; 2],
    /// First derivative at both ends.
    pub(crate) slope: [SVector<f64, N>; 2],
    /// Second derivative at both ends.
    pub(crate) curvature: [SVector<f64, N>; 2],
}

impl<const N: usize> DenseStep<N> {
    /// When the step ends, s.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.length_s
    }

    /// State at the end of the step.
    pub fn end(&self) -> SVector<f64, N> {
        self.value[1]
    }

    /// State at time `t_s` inside the step.
    pub fn at(&self, t_s: f64) -> SVector<f64, N> {
        let x = (t_s - self.start_s) / self.length_s;
        let h = self.length_s;
        let (x2, x3) = (x * x, x * x * x);
        let w5 = x3 * (10.0 + x * (-15.0 + 6.0 * x));
        let w1 = x + x3 * (-6.0 + x * (8.0 - 3.0 * x));
        let w2 = 0.5 * x2 + x3 * (-1.5 + x * (1.5 - 0.5 * x));
        let w4 = x3 * (-4.0 + x * (7.0 - 3.0 * x));
        let w3 = x3 * (0.5 + x * (-1.0 + 0.5 * x));
        self.value[0]
            + (self.value[1] - self.value[0]) * w5
            + (self.slope[0] * w1 + self.slope[1] * w4) * h
            + (self.curvature[0] * w2 + self.curvature[1] * w3) * (h * h)
    }

    /// One state as a polynomial in (t - start) / length, from 0 to 1.
    pub fn polynomial(&self, state: usize) -> Polynomial {
        let h = self.length_s;
        let [y0, y1] = self.value.map(|y| y[state]);
        let [d0, d1] = self.slope.map(|y| y[state] * h);
        let [e0, e1] = self.curvature.map(|y| y[state] * h * h);
        let rise = y1 - y0;
        Polynomial {
            c: [
                y0,
                d0,
                0.5 * e0,
                10.0 * rise - 6.0 * d0 - 4.0 * d1 - 1.5 * e0 + 0.5 * e1,
                -15.0 * rise + 8.0 * d0 + 7.0 * d1 + 1.5 * e0 - e1,
                6.0 * rise - 3.0 * (d0 + d1) + 0.5 * (e1 - e0),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quintic_is_reproduced() {
        let p = Polynomial { c: [1.0, -2.0, 0.5, 3.0, -1.0, 0.25] };
        let (d, e) = (p.derivative(), p.derivative().derivative());
        let ends = |q: &Polynomial| [SVector::<f64, 1>::new(q.at(1.0)), SVector::<f64, 1>::new(q.at(1.5))];
        let step =
            DenseStep { start_s: 1.0, length_s: 0.5, value: ends(&p), slope: ends(&d), curvature: ends(&e) };
        for t in [1.0, 1.1, 1.25, 1.4, 1.5] {
            assert!((step.at(t)[0] - p.at(t)).abs() < 1e-14);
            assert!((step.polynomial(0).at((t - 1.0) / 0.5) - p.at(t)).abs() < 1e-14);
        }
    }
}
