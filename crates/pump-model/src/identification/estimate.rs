//! Values with their uncertainty.

use libm::sqrt;

use super::student::widening;

/// Value with its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// Best estimate of the value.
    pub value: f64,
    /// Standard uncertainty, in the unit of the value. Student's t widens it, so that twice it covers 95 %
    /// however few measurements there were.
    pub standard: f64,
}

impl Estimate {
    /// Builds the estimate of a value whose variance was estimated with this many degrees of freedom.
    pub(super) fn new(value: f64, variance: f64, degrees_of_freedom: u32) -> Self {
        Self { value, standard: widening(degrees_of_freedom) * sqrt(variance) }
    }

    /// Returns `factor` times this estimate.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { value: factor * self.value, standard: factor.abs() * self.standard }
    }

    /// Returns 1 over this estimate. The relative uncertainty stays the same where it is small.
    #[must_use]
    pub fn inverse(self) -> Self {
        let value = 1.0 / self.value;
        Self { value, standard: self.standard * value * value }
    }

    /// True if 0 lies more than twice the standard uncertainty away.
    pub fn differs_from_zero(&self) -> bool {
        2.0 * self.standard < self.value.abs()
    }
}
