//! Range and mean of one port's pressure over a pitch.

use crate::integrator::COEFFICIENTS;
use crate::line::extremes::Extremes;
use crate::math::polynomial::Polynomial;

/// Range and mean of one port's pressure over a pitch, gathered step by step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PressureTally {
    pub(crate) time_s: f64,
    range: Extremes,
    integral_kpa_s: f64,
}

impl PressureTally {
    pub(crate) const EMPTY: Self = Self {
        time_s: 0.0,
        range: Extremes { min_kpa: f64::INFINITY, max_kpa: f64::NEG_INFINITY },
        integral_kpa_s: 0.0,
    };

    /// Adds a step of `length_s`. `pressure` is in kPa, over the fraction of the step from 0 to 1.
    pub(crate) fn add(&mut self, length_s: f64, pressure: &Polynomial<COEFFICIENTS>) {
        let ((_, low), (_, high)) = pressure.range_in(0.0, 1.0);
        self.range.cover(low);
        self.range.cover(high);
        self.time_s += length_s;
        self.integral_kpa_s += length_s * integral(pressure);
    }

    /// Returns the range of the pressure, kPa.
    pub(crate) fn range(&self) -> Extremes {
        self.range
    }

    /// Returns the mean pressure, kPa.
    pub(crate) fn mean_kpa(&self) -> f64 {
        self.integral_kpa_s / self.time_s
    }
}

/// Integral of a polynomial over [0, 1].
fn integral(polynomial: &Polynomial<COEFFICIENTS>) -> f64 {
    polynomial.c.iter().zip(1..).map(|(c, n)| c / f64::from(n)).sum()
}
