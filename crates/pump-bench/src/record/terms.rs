//! What was asked of a dose besides its volume.

use serde::{Deserialize, Serialize};

/// What was asked of a dose besides its volume: the rest of one that is cut off keeps to it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Terms {
    /// Cruise speed, rad/s, of a smooth flow its mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cruise_rad_s: Option<f64>,
    /// Whether the speed followed the rollers' angle for a smooth flow.
    #[serde(default)]
    pub smooth: bool,
    /// Whether it was to end at low flow.
    #[serde(default)]
    pub low_flow: bool,
    /// Limit at the port that pushes, kPa absolute, in place of the pump file's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_outlet_kpa: Option<f64>,
    /// Limit at the port that sucks, kPa absolute, in place of the pump file's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_inlet_kpa: Option<f64>,
}

impl Terms {
    pub(super) fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
