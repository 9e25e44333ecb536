//! The weighing of the last dose, where a balance ended it.

use serde::{Deserialize, Serialize};

/// Weighing of a dose that a balance ended.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct DoseByWeight {
    /// Mass that the balance was to show, in g.
    pub target_g: f64,
    /// Mass that the balance showed at rest, in g.
    pub mass_g: f64,
    /// Step of the balance's last digit, in g.
    pub digit_g: f64,
    /// Volume of the mass that the balance showed, in mL.
    pub weighed_ml: f64,
    /// Volume that the pump turned for by the model, in mL.
    pub turned_ml: f64,
    /// Carry of earlier doses that was dropped, in mL.
    pub dropped_ml: f64,
}
