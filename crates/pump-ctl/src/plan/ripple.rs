//! The ripple of the flow at the outlet's rollers and at the end of the outlet line.

use pump_model::units::degrees;
use pump_model::{Leg, Pump, Ripple};

use super::Plan;
use super::profile::SpeedLimit;
use super::words::PlanError;

/// Ripples over time of the flow while cruising, without and with smoothing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Ripples {
    /// Ripple at the outlet's rollers at constant speed, with the same mean flow.
    pub before: Ripple,
    /// Ripple at the outlet's rollers at the planned speed.
    pub after: Ripple,
    /// Ripple at the end of the outlet line at constant speed. There is none at an undamped resonance.
    pub outflow_before: Option<Ripple>,
    /// Ripple at the end of the outlet line at the planned speed. There is none at an undamped resonance.
    pub outflow_after: Option<Ripple>,
}

impl Plan {
    /// Returns true if the speed follows the angle for a smooth flow.
    pub fn is_smooth(&self) -> bool {
        matches!(self.profile.course.limit, SpeedLimit::Smooth(_))
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
        let still = Ripple { peak_to_peak: 0.0, rms: 0.0 };
        let worst = |one: Ripple, other: Ripple| Ripple {
            peak_to_peak: one.peak_to_peak.max(other.peak_to_peak),
            rms: one.rms.max(other.rms),
        };
        let middle = self.ripples_beside(pump, 0.0);
        if !self.is_smooth() {
            return middle;
        }
        self.start.beside(pump.pitch_rad()).fold(middle, |ripples, off_rad| {
            let there = self.ripples_beside(pump, off_rad);
            Ripples {
                after: worst(ripples.after, there.after),
                outflow_after: ripples
                    .outflow_after
                    .map(|outflow| worst(outflow, there.outflow_after.unwrap_or(still))),
                ..ripples
            }
        })
    }

    /// Returns the ripples of the planned motion on `pump` while cruising, where the rollers stand `off_rad`
    /// beside the angle that the plan assumes.
    ///
    /// The motion stays that of the plan. So the ripples on a pump with another roller volume than the planned
    /// one tell the price of not knowing it.
    pub fn ripples_beside(&self, pump: &Pump, off_rad: f64) -> Ripples {
        let before = pump.outlet_curve().ripple();
        let speed_rad_s = f64::from(self.direction().sign()) * self.profile.cruise_rad_s();
        let outflow_before = pump.constant_speed_outflow_ripple(speed_rad_s);
        if !self.is_smooth() {
            return Ripples { before, after: before, outflow_before, outflow_after: outflow_before };
        }
        let outflow_after = pump.outflow_ripple(self.pitch_beside(off_rad));
        Ripples { before, after: self.ripple_beside(pump, off_rad), outflow_before, outflow_after }
    }

    /// Refuses a smooth flow that may be less smooth than the flow at constant speed.
    pub(super) fn check_ripples(&self, pump: &Pump) -> Result<(), PlanError> {
        if !self.is_smooth() || self.start.half_width_rad == 0.0 {
            return Ok(());
        }
        let before = pump.outlet_curve().ripple();
        let beside = self.start.beside(pump.pitch_rad());
        let after = beside.map(|off_rad| self.ripple_beside(pump, off_rad).rms).fold(0.0, f64::max);
        if after < before.rms {
            return Ok(());
        }
        Err(PlanError::SmoothWithoutAngle {
            half_width_deg: degrees(self.start.half_width_rad),
            ripple_percent: 100.0 * after,
            constant_percent: 100.0 * before.rms,
        })
    }

    /// Returns the ripple at the rollers where they stand `off_rad` beside the angle that the plan assumes.
    fn ripple_beside(&self, pump: &Pump, off_rad: f64) -> Ripple {
        Ripple::of_motion(pump.outlet_curve(), self.pitch_beside(off_rad))
            .unwrap_or_else(|| pump.outlet_curve().ripple())
    }

    /// Returns the legs of a pitch of a smooth flow, where the rollers stand `off_rad` beside.
    fn pitch_beside(&self, off_rad: f64) -> impl Iterator<Item = Leg> + Clone {
        self.profile.pitch_along().map(move |leg| leg.beside(off_rad))
    }
}
