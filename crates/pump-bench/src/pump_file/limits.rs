//! `[limits]`: the pressures that a dose must keep, beside the limits of motor, tube and fluid.

pub(super) mod safety;

use serde::{Deserialize, Serialize};

/// The table `[limits]`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct LimitsTable {
    /// Largest pressure at the discharge port, in kPa absolute.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_outlet_kpa: Option<f64>,
    /// Smallest pressure at the suction port, in kPa absolute.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_inlet_kpa: Option<f64>,
}

impl LimitsTable {
    /// Returns true if the table limits nothing.
    pub(super) fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
