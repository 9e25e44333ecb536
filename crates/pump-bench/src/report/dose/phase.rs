//! Knowledge of the angle at which a dose started.

use pump_ctl::plan::Phase;
use pump_model::units::{degrees, radians};
use serde::Serialize;

use crate::dosing::Prepared;
use crate::record::PhaseSource;

/// Knowledge of the start angle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct PhaseReport {
    /// True if the angle is known.
    pub known: bool,
    /// Source of the angle.
    pub source: PhaseSource,
    /// Largest error of the angle either way, deg.
    pub half_width_deg: f64,
}

impl PhaseReport {
    /// True if the dose was planned from the angle itself, and not for the worst case over many angles.
    pub(in crate::report) fn is_stated(&self) -> bool {
        Phase::within(0.0, radians(self.half_width_deg)).is_stated()
    }

    pub(in crate::report) fn of(prepared: &Prepared) -> Self {
        // Only the angle within a pitch matters.
        let half_width_rad = prepared.plan.start().half_width_rad().min(0.5 * prepared.model.pitch_rad());
        Self {
            known: prepared.plan.start().is_known(prepared.model.pitch_rad()),
            source: prepared.phase_source,
            half_width_deg: degrees(half_width_rad),
        }
    }
}
