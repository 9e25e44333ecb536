//! Ranges of pressures over time.

/// Smallest and largest pressure, kPa absolute.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Extremes {
    /// Smallest pressure, kPa absolute.
    pub min_kpa: f64,
    /// Largest pressure, kPa absolute.
    pub max_kpa: f64,
}

impl Extremes {
    /// Returns the extremes of a single pressure, kPa absolute.
    pub fn at(pressure_kpa: f64) -> Self {
        Self { min_kpa: pressure_kpa, max_kpa: pressure_kpa }
    }

    /// Widens the range to a pressure.
    pub(crate) fn cover(&mut self, pressure_kpa: f64) {
        self.min_kpa = self.min_kpa.min(pressure_kpa);
        self.max_kpa = self.max_kpa.max(pressure_kpa);
    }

    /// Returns the range that covers this range and another.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { min_kpa: self.min_kpa.min(other.min_kpa), max_kpa: self.max_kpa.max(other.max_kpa) }
    }

    pub(crate) fn above(self, base_kpa: f64) -> Self {
        Self { min_kpa: self.min_kpa + base_kpa, max_kpa: self.max_kpa + base_kpa }
    }
}
