//! The predicted pressures of a dose, and the time in which its line settles.

use pump_model::{ExactRun, Extremes, Leg, LineState, Port, Pump};

use super::shortened_motion::ShortenedMotion;
use crate::plan::Plan;
use crate::plan::words::PlanError;

/// Predicted pressures over a dose, start-up, stop and settling included, for the smooth motion through the
/// steps.
///
/// If the start angle is not known exactly, the ranges cover every angle at which the rollers may stand.
/// These angles are looked at a sixteenth of a pitch apart.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Prediction {
    /// Range of the pressure at the inlet, kPa absolute.
    pub inlet: Extremes,
    /// Range of the pressure at the outlet, kPa absolute.
    pub outlet: Extremes,
    /// Largest distance of a pressure from this prediction by the motor's steps, kPa. Steps near the line's
    /// swing add up.
    pub step_kpa: f64,
    /// Time from the last step until the undelivered volume stays below 1 uL, s. It is the longest from any
    /// angle at which the rollers may stand.
    pub settle_s: f64,
}

impl Plan {
    /// Predicts pressures and settling of this dose on `pump`, exactly.
    ///
    /// # Errors
    ///
    /// Fails with [`PlanError::Model`] if the model cannot find the time at which the line settles.
    pub fn predict(&self, pump: &Pump) -> Result<Prediction, PlanError> {
        let range = |port| {
            let beside = self.start.beside(pump.pitch_rad());
            let ranges = beside.map(|off_rad| ShortenedMotion::new(self, pump, off_rad).extremes(pump, port));
            // There is always a look at the middle.
            ranges.reduce(Extremes::and).unwrap_or(Extremes::at(pump.line(port).reservoir_kpa))
        };
        Ok(Prediction {
            inlet: range(Port::Inlet),
            outlet: range(Port::Outlet),
            step_kpa: self.step_kpa(pump, Port::Inlet).max(self.step_kpa(pump, Port::Outlet)),
            settle_s: self.settle_s(pump)?,
        })
    }

    /// Returns the largest distance of a port's pressure from that of the smooth motion by the motor's steps,
    /// kPa. See [`pump_model::Line::worst_step_kpa_ml`].
    pub(in crate::plan) fn step_kpa(&self, pump: &Pump, port: Port) -> f64 {
        let largest_ml = pump.curve(port).largest_flow_ml_rad() * self.step_rad;
        let (shortest_s, longest_s) = (self.step_rad / self.profile.peak_rad_s(), self.longest_interval_s());
        largest_ml * pump.line(port).worst_step_kpa_ml(shortest_s, longest_s, self.profile.duration_s())
    }

    /// Returns a bound of the time between two steps, s. The rotor is slowest at the first step, at the last,
    /// or along the speed limit.
    fn longest_interval_s(&self) -> f64 {
        let (profile, turn_rad) = (&self.profile, self.steps.unsigned_abs() as f64 * self.step_rad);
        let first_s = profile.time_of(self.step_rad);
        let last_s = profile.duration_s() - profile.time_of(turn_rad - self.step_rad);
        let along_s = if profile.reaches_limit() { self.step_rad / profile.slowest_rad_s() } else { 0.0 };
        first_s.max(last_s).max(along_s)
    }

    /// Returns the time from the last step until the undelivered volume stays below 1 uL, s. It is the
    /// longest from any angle at which the rollers may stand.
    pub(in crate::plan) fn settle_s(&self, pump: &Pump) -> Result<f64, PlanError> {
        let mut longest_s: f64 = 0.0;
        for off_rad in self.start.beside(pump.pitch_rad()) {
            longest_s = longest_s.max(self.settle_beside_s(pump, off_rad)?);
        }
        Ok(longest_s)
    }

    /// Returns the settling time where the rollers stand `off_rad` beside the middle of their range, s. The
    /// last step comes at once, so its volume is in the line at first.
    fn settle_beside_s(&self, pump: &Pump, off_rad: f64) -> Result<f64, PlanError> {
        let motion = ShortenedMotion::new(self, pump, off_rad);
        let state = motion.run(pump, Port::Outlet).at(motion.duration_s());
        let end_rad = self.end_angle_rad() + off_rad;
        let step_ml =
            pump.outlet_curve().flow_ml_rad(end_rad) * self.step_rad * f64::from(self.direction().sign());
        let stepped_kpa = state.above_reservoir_kpa + step_ml / pump.outlet().compliance_ml_kpa;
        let stepped = LineState { above_reservoir_kpa: stepped_kpa, ..state };
        let rest = [Leg::rest(0.0, end_rad)];
        Ok(ExactRun::new(pump, Port::Outlet, rest, stepped).settling_s()?)
    }
}
