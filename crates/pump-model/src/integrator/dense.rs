//! Solution between the ends of a step.

use nalgebra::SVector;

use crate::math::hermite::{self, End};
use crate::math::polynomial::Polynomial;

/// Accepted step with its dense output: every state as a polynomial in x = (t - start) / length.
#[derive(Debug, Clone, Copy)]
pub struct DenseStep<const N: usize> {
    /// Start of the step, s.
    pub start_s: f64,
    /// Length of the step, s.
    pub length_s: f64,
    end: SVector<f64, N>,
    /// Coefficients, lowest order first.
    c: [SVector<f64, N>; COEFFICIENTS],
}

/// Number of coefficients of a step's polynomials: those of Radau's method have degree seven, Hermite's five.
pub const COEFFICIENTS: usize = 8;

impl<const N: usize> DenseStep<N> {
    /// Builds a step that ends in the state `end`, with these coefficients, lowest order first.
    pub(super) fn new(
        start_s: f64,
        length_s: f64,
        end: SVector<f64, N>,
        c: [SVector<f64, N>; COEFFICIENTS],
    ) -> Self {
        Self { start_s, length_s, end, c }
    }

    /// Builds the quintic Hermite polynomial through both ends.
    ///
    /// The curvature J f + f_t is exact along the solution, so the polynomial is of order six. In a stiff
    /// problem J magnifies the error of the ends by (h |J|)².
    pub(crate) fn hermite(
        start_s: f64,
        length_s: f64,
        from: &End<SVector<f64, N>>,
        to: &End<SVector<f64, N>>,
    ) -> Self {
        let [c0, c1, c2, c3, c4, c5] = hermite::quintic(length_s, from, to);
        Self::new(start_s, length_s, to.value, [c0, c1, c2, c3, c4, c5, SVector::zeros(), SVector::zeros()])
    }

    /// Builds RODAS5P's own output of order four, y0 (1 - x) + x (y1 + (1 - x) (k1 + x (k2 + x k3))). It
    /// stays between the ends however stiff the problem is.
    pub(crate) fn own(
        start_s: f64,
        length_s: f64,
        from: SVector<f64, N>,
        to: SVector<f64, N>,
        k: [SVector<f64, N>; 3],
    ) -> Self {
        let none = SVector::zeros();
        let c = [from, to - from + k[0], k[1] - k[0], k[2] - k[1], -k[2], none, none, none];
        Self::new(start_s, length_s, to, c)
    }

    /// Returns the end of the step, s.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.length_s
    }

    /// Returns the state at the end of the step.
    pub fn end(&self) -> [f64; N] {
        self.end.into()
    }

    /// Returns the state at time `t_s` inside the step.
    pub fn at(&self, t_s: f64) -> [f64; N] {
        let x = (t_s - self.start_s) / self.length_s;
        let [lower @ .., highest] = &self.c;
        lower.iter().rev().fold(*highest, |sum, c| sum * x + c).into()
    }

    /// Returns one state as a polynomial in (t - start) / length, from 0 to 1.
    ///
    /// # Panics
    ///
    /// Panics if `state` is not less than `N`.
    pub fn polynomial(&self, state: usize) -> Polynomial<COEFFICIENTS> {
        Polynomial { c: self.c.map(|c| c[state]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quintic_is_reproduced() {
        let p = Polynomial { c: [1.0, -2.0, 0.5, 3.0, -1.0, 0.25] };
        let (d, e) = (p.derivative(), p.derivative().derivative());
        let vector = |x| SVector::<f64, 1>::new(x);
        let end = |t| End { value: vector(p.at(t)), slope: vector(d.at(t)), curvature: vector(e.at(t)) };
        let step = DenseStep::hermite(1.0, 0.5, &end(1.0), &end(1.5));
        for t in [1.0, 1.1, 1.25, 1.4, 1.5] {
            assert!((step.at(t)[0] - p.at(t)).abs() < 1e-14);
            assert!((step.polynomial(0).at((t - 1.0) / 0.5) - p.at(t)).abs() < 1e-14);
        }
    }
}
