//! Where a start angle comes from.

use serde::{Deserialize, Serialize};

/// Where the start angle comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PhaseSource {
    /// Set by hand or found by a sensor; a fresh simulated pump stands at 0 deg.
    Home,
    /// The rotor's mark was turned to the housing's.
    Mark,
    /// The record of motion since then.
    #[default]
    Recorded,
    /// The request.
    Given,
    /// Nobody knows: the middle of what may be.
    Assumed,
}
