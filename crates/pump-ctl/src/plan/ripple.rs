//! The ripple of the flow at the outlet's rollers.

use pump_model::units::degrees;
use pump_model::{Pump, Ripple};

use super::Plan;
use super::profile::SpeedLimit;
use super::words::PlanError;

/// Ripples over time of the flow at the outlet's rollers while cruising, without and with smoothing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Ripples {
    /// Ripple at constant speed, with the same mean flow.
    pub before: Ripple,
    /// Ripple at the planned speed.
    pub after: Ripple,
}

impl Plan {
    /// Returns true if the speed follows the angle for a smooth flow.
    pub fn is_smooth(&self) -> bool {
        matches!(self.profile.course.limit, SpeedLimit::Smooth { .. })
    }

    /// Returns the mean flow over whole pitches while cruising, mL/s, not negative. A turn too short to
    /// cruise gives the flow of its fastest speed.
    pub fn cruise_flow_ml_s(&self, pump: &Pump) -> f64 {
        pump.average_flow_ml_s(self.profile.cruise_rad_s())
    }

    /// Returns the ripples of the periodic flow while cruising. A dose too short to cruise does not reach
    /// them.
    ///
    /// If the angle is not known exactly, each ripple is the worst over the angles at which the rollers may
    /// stand. These angles are a sixteenth of a pitch apart at most.
    pub fn ripples(&self, pump: &Pump) -> Ripples {
        let before = pump.outlet_curve().ripple();
        if !self.is_smooth() {
            return Ripples { before, after: before };
        }
        let mut after = Ripple { peak_to_peak: 0.0, rms: 0.0 };
        for off_rad in self.start.beside(pump.pitch_rad()) {
            let there = self.ripple_beside(pump, off_rad);
            after.peak_to_peak = after.peak_to_peak.max(there.peak_to_peak);
            after.rms = after.rms.max(there.rms);
        }
        Ripples { before, after }
    }

    /// Refuses a smooth flow that may be less smooth than the flow at constant speed.
    pub(super) fn check_ripples(&self, pump: &Pump) -> Result<(), PlanError> {
        if !self.is_smooth() || self.start.half_width_rad == 0.0 {
            return Ok(());
        }
        let Ripples { before, after } = self.ripples(pump);
        if after.rms < before.rms {
            return Ok(());
        }
        Err(PlanError::SmoothWithoutAngle {
            half_width_deg: degrees(self.start.half_width_rad),
            ripple_percent: 100.0 * after.rms,
            constant_percent: 100.0 * before.rms,
        })
    }

    /// Returns the ripple where the rollers stand `off_rad` beside the angle that the plan assumes.
    fn ripple_beside(&self, pump: &Pump, off_rad: f64) -> Ripple {
        let legs = self.profile.pitch_along().map(|leg| leg.beside(off_rad));
        Ripple::of_motion(pump.outlet_curve(), legs).unwrap_or_else(|| pump.outlet_curve().ripple())
    }
}
