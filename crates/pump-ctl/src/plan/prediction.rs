//! Which pressures a dose will make, and how long its line needs to settle.

use pump_model::{ExactRun, Extremes, Leg, Port, Pump};

use super::{Legs, Plan, PlanError};

/// Pressures over a dose, start-up, stop and settling included, for the smooth motion through the
/// steps. From an angle that is not known exactly, those from the middle of what it may be.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Prediction {
    /// Range at the inlet, kPa absolute.
    pub inlet: Extremes,
    /// Range at the outlet, kPa absolute.
    pub outlet: Extremes,
    /// What a single motor step adds to or takes from these at most, kPa: its volume over the compliance.
    pub step_kpa: f64,
    /// Time from the last step until the undelivered volume stays below 1 uL, s.
    pub settle_s: f64,
}

impl Plan {
    /// The motion: ramp, cruise, ramp; then the motor holds.
    pub fn legs(&self) -> Legs<'_> {
        self.profile.legs()
    }

    /// Predicts pressures and settling of this dose on `pump`, exactly.
    pub fn predict(&self, pump: &Pump) -> Result<Prediction, PlanError> {
        let range = |port| self.run(pump, port).extremes_to_rest(self.profile.duration_s());
        let step_kpa = |port| {
            let largest_ml = pump.curve(port).flow_range_ml_rad().1 * self.step_rad;
            largest_ml / pump.line(port).compliance_ml_kpa
        };
        Ok(Prediction {
            inlet: range(Port::Inlet),
            outlet: range(Port::Outlet),
            step_kpa: step_kpa(Port::Inlet).max(step_kpa(Port::Outlet)),
            settle_s: self.settle_s(pump)?,
        })
    }

    /// Time from the last step until the undelivered volume stays below 1 uL, s. The last step comes at once, so its volume is
    /// in the line at first.
    pub(super) fn settle_s(&self, pump: &Pump) -> Result<f64, PlanError> {
        let [pressure_kpa, flow_ml_s] = self.run(pump, Port::Outlet).at(self.profile.duration_s());
        let end_rad = self.end_angle_rad();
        let step_ml = self.end_step_ml(pump) * f64::from(self.direction());
        let stepped_kpa = pressure_kpa + step_ml / pump.outlet().compliance_ml_kpa;
        let rest = [Leg::rest(0.0, end_rad)];
        Ok(ExactRun::new(pump, Port::Outlet, rest, [stepped_kpa, flow_ml_s]).settling_s()?)
    }
}
