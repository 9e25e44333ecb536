//! `[backplate]`: the raceway against which the rollers squeeze the tube.

use serde::{Deserialize, Serialize};

/// The table `[backplate]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct BackplateTable {
    /// Radius of the backplate r_b, in mm.
    pub radius_mm: f64,
    /// Contact angle beta, in deg. The backplate spans 180 + 2 beta.
    pub contact_angle_deg: f64,
}
