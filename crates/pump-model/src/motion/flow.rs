//! The flow at the rollers as a polynomial of time.

use crate::math::polynomial::{shift_coefficients, shifted_quartic};

/// Highest degree of the flow over time. The flow is a quartic in the angle, which is quadratic in time,
/// times the speed.
pub(crate) const DEGREE: usize = 9;

/// Flow at the rollers as a polynomial in the time since some instant, lowest order first, mL/s^(n+1).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Flow {
    pub(crate) c: [f64; DEGREE + 1],
    /// Highest order whose coefficient may differ from zero.
    pub(crate) degree: usize,
}

impl Flow {
    /// Returns a flow that does not change, mL/s.
    pub(crate) fn even(flow_ml_s: f64) -> Self {
        let mut flow = Self::default();
        flow.c[0] = flow_ml_s;
        flow
    }

    /// Returns the flow at `t`, mL/s.
    pub(crate) fn at(&self, t: f64) -> f64 {
        self.terms().rev().fold(0.0, |sum, c| sum * t + c)
    }

    /// Returns the polynomial in the time since `t`.
    pub(crate) fn shifted(&self, t: f64) -> Self {
        let mut shifted = *self;
        if self.degree <= 4 {
            let (quartic, _) = shifted.c.split_at_mut(5);
            quartic.copy_from_slice(&self.quartic_after(t));
            return shifted;
        }
        let count = shifted.c.len().min(self.degree + 1);
        shift_coefficients(&mut shifted.c[..count], t);
        shifted
    }

    /// Returns the polynomial in the time since `t` of a flow of degree 4 at most, lowest order first.
    #[inline]
    pub(crate) fn quartic_after(&self, t: f64) -> [f64; 5] {
        let [c0, c1, c2, c3, c4, ..] = self.c;
        if self.degree == 0 {
            return [c0, 0.0, 0.0, 0.0, 0.0];
        }
        shifted_quartic([c0, c1, c2, c3, c4], t)
    }

    /// Returns this flow without `other`, which counts time from `since_s` before. Both are of degree 4 at most.
    #[inline]
    pub(crate) fn less(&self, other: &Self, since_s: f64) -> [f64; 5] {
        let mut rest = other.quartic_after(since_s);
        for (rest, c) in rest.iter_mut().zip(self.c) {
            *rest = c - *rest;
        }
        rest
    }

    /// Returns the derivative at `t`, mL/s².
    pub(crate) fn rate_at(&self, t: f64) -> f64 {
        self.terms().enumerate().skip(1).rev().fold(0.0, |sum, (n, c)| sum * t + n as f64 * c)
    }

    /// Returns the volume from 0 to `t`, mL.
    pub(crate) fn volume(&self, t: f64) -> f64 {
        t * self.terms().enumerate().rev().fold(0.0, |sum, (n, c)| sum * t + c / (n + 1) as f64)
    }

    /// Returns the coefficients up to the degree.
    pub(crate) fn terms(&self) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator {
        self.c.into_iter().take(self.degree + 1)
    }
}
