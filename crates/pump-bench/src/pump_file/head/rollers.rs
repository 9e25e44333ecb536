//! `[rollers]`: the rollers that squeeze the tube.

use serde::{Deserialize, Serialize};

/// The table `[rollers]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct RollersTable {
    /// Number of rollers, NU.
    pub count: u32,
    /// Radius of a roller r_roller, in mm. `None` beside `[head]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius_mm: Option<f64>,
    /// Distance from the rotor's axis to a roller's axis r_offset, in mm. `None` beside `[head]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offset_mm: Option<f64>,
}

impl RollersTable {
    /// Number that stands for a number that the file does not give. No head has as many rollers.
    const NOT_GIVEN: u32 = u32::MAX;

    /// Returns the table of a file without `[rollers]`.
    pub(in crate::pump_file) fn not_given() -> Self {
        Self { count: Self::NOT_GIVEN, radius_mm: None, offset_mm: None }
    }

    /// Returns true if the number of rollers is known.
    pub(in crate::pump_file) fn is_given(&self) -> bool {
        self.count != Self::NOT_GIVEN
    }
}
