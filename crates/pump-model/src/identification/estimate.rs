//! A value and how sure it is.

use crate::math::sqrt;

use super::student::widening;

/// A value with its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard uncertainty, in the unit of the value, widened by Student's t so that twice it covers 95 % however
    /// few measurements there were.
    pub standard: f64,
}

impl Estimate {
    /// Estimate of a value whose variance was estimated with so many degrees of freedom.
    pub(super) fn new(value: f64, variance: f64, degrees_of_freedom: u32) -> Self {
        Self { value, standard: widening(degrees_of_freedom) * sqrt(variance) }
    }

    /// `factor` times as much.
    pub fn times(self, factor: f64) -> Self {
        Self { value: factor * self.value, standard: factor.abs() * self.standard }
    }

    /// 1 over the value, whose relative uncertainty is the same where it is small.
    pub fn inverse(self) -> Self {
        let value = 1.0 / self.value;
        Self { value, standard: self.standard * value * value }
    }

    /// True if 0 lies more than twice the standard uncertainty away.
    pub fn differs_from_zero(&self) -> bool {
        2.0 * self.standard < self.value.abs()
    }
}
