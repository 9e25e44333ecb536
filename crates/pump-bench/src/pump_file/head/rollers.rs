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
