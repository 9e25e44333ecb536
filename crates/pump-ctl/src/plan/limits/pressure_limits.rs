//! The pressure limits of a dose.

use crate::parameter::Parameter;
use crate::plan::words::{Allowed, PlanError, SetBy, within};

/// The pressures that the user has set as limits. A limit of `None` is not checked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PressureLimits {
    /// Largest pressure at the discharge port, kPa absolute, 1e-9 to 1e6. `None` is not checked.
    pub max_outlet_kpa: Option<f64>,
    /// Smallest pressure at the suction port, kPa absolute, up to 1e6 either way. `None` is not checked.
    pub min_inlet_kpa: Option<f64>,
}

impl PressureLimits {
    /// Pressure limits that limit nothing.
    pub const NONE: Self = Self { max_outlet_kpa: None, min_inlet_kpa: None };

    /// Returns these limits, with the limit of `others` in place of each that is `None`.
    ///
    /// ```
    /// use pump_ctl::plan::PressureLimits;
    ///
    /// let asked = PressureLimits { max_outlet_kpa: Some(150.0), ..PressureLimits::NONE };
    /// let usual = PressureLimits { max_outlet_kpa: Some(200.0), min_inlet_kpa: Some(60.0) };
    /// assert_eq!(asked.or(usual), PressureLimits { max_outlet_kpa: Some(150.0), min_inlet_kpa: Some(60.0) });
    /// ```
    #[must_use]
    pub fn or(self, others: Self) -> Self {
        Self {
            max_outlet_kpa: self.max_outlet_kpa.or(others.max_outlet_kpa),
            min_inlet_kpa: self.min_inlet_kpa.or(others.min_inlet_kpa),
        }
    }

    /// Refuses limits that mean nothing.
    ///
    /// # Errors
    ///
    /// Returns [`PlanError::OutOfRange`] for a limit outside its range.
    pub fn validate(&self) -> Result<(), PlanError> {
        if let Some(kpa) = self.max_outlet_kpa {
            within(Parameter::OutletLimit, kpa, Allowed::Between { least: 1e-9, most: 1e6 })?;
        }
        if let Some(kpa) = self.min_inlet_kpa {
            within(Parameter::InletLimit, kpa, Allowed::EitherWay { most: 1e6 })?;
        }
        Ok(())
    }
}

/// The smallest pressure that is allowed at a port.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Lowest {
    /// Pressure, kPa absolute, up to 1e6 either way.
    pub kpa: f64,
    /// Origin of the pressure.
    pub set_by: SetBy,
}

impl Lowest {
    pub(super) fn validate(&self) -> Result<(), PlanError> {
        within(Parameter::SmallestPressure, self.kpa, Allowed::EitherWay { most: 1e6 })
    }
}
