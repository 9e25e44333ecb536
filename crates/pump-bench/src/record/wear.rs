//! The wear of a tube since it was new.

use serde::{Deserialize, Serialize};

/// Wear of a tube since it was new.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Wear {
    /// Volume pumped in either direction, in mL.
    pub volume_ml: f64,
    /// Revolutions in either direction.
    pub revolutions: f64,
    /// Time in motion, in s.
    pub motion_s: f64,
}
