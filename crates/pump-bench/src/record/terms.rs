//! The terms of a dose besides its volume.

use pump_ctl::plan::PressureLimits;
use serde::{Deserialize, Serialize};

/// Terms of a dose besides its volume, in the form of the journal. The rest of a dose that was cut off keeps to them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Terms {
    /// Cruise speed, in rad/s. For a smooth flow it is the mean speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cruise_rad_s: Option<f64>,
    /// True if the speed followed the rollers' angle for a smooth flow.
    #[serde(default)]
    pub smooth: bool,
    /// True if the dose was to end at low flow.
    #[serde(default)]
    pub low_flow: bool,
    /// Pressure limit at the discharge port, in kPa absolute. `None` takes the pump file's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_outlet_kpa: Option<f64>,
    /// Pressure limit at the suction port, in kPa absolute. `None` takes the pump file's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_inlet_kpa: Option<f64>,
}

impl Terms {
    /// Returns the pressure limits of the terms.
    pub(crate) fn pressures(&self) -> PressureLimits {
        PressureLimits { max_outlet_kpa: self.max_outlet_kpa, min_inlet_kpa: self.min_inlet_kpa }
    }

    pub(super) fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
