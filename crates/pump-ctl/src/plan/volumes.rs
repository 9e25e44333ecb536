//! The volumes that a plan's steps deliver.

use libm::floor;
use pump_model::Pump;

use super::Plan;
use super::target::{booked, delivered, ends, first};
use super::words::{Phase, PlanError};

impl Plan {
    /// Returns the volume of the first `count` steps once the line has settled, mL, negative in reverse. It
    /// lies within [`Self::range_ml`]. From an angle that is not stated it is the middle for a dose alone.
    pub fn delivered_ml(&self, pump: &Pump, count: u64) -> f64 {
        self.turned_after(count).middle_ml(pump) - self.turned.middle_ml(pump)
    }

    /// Returns the smallest and the largest volume of the first `count` steps, mL, over the angles at which
    /// the rollers may stand. Both are equal if the angle is known exactly.
    pub fn range_ml(&self, pump: &Pump, count: u64) -> (f64, f64) {
        let steps = f64::from(self.direction().sign()) * count as f64;
        delivered(pump, self.start, steps, self.step_rad)
    }

    /// Returns the volume of the last step, mL, not negative, which is the resolution of the dose at its end.
    pub fn end_step_ml(&self, pump: &Pump) -> f64 {
        pump.outlet_curve().flow_ml_rad(self.end_angle_rad()).abs() * self.step_rad
    }

    /// Returns the volumes, mL, of the two ends at low flow next to the volume requested plus carried. They
    /// are the largest that is no more, and the smallest that is no less.
    ///
    /// A volume is `None` if the dose's direction has no such end. A dose of a returned volume ends there and
    /// carries nothing.
    ///
    /// # Errors
    ///
    /// Fails with [`PlanError::NoLowFlow`] if the outlet's flow is never low, and with
    /// [`PlanError::LowFlowWithoutAngle`] if the start angle is not known well enough.
    pub fn low_flow_volumes_ml(&self, pump: &Pump) -> Result<[Option<f64>; 2], PlanError> {
        let (curve, start_rad) = (pump.outlet_curve(), self.start.angle_rad);
        let owed_ml = self.requested_ml + self.carry_in_ml;
        let nearest = if curve.reverses() {
            first(pump, Phase::known(start_rad), owed_ml, self.step_rad).0
        } else {
            let ideal_rad = curve.angle_rad(curve.volume_ml(start_rad) + owed_ml) - start_rad;
            floor(ideal_rad / self.step_rad + 0.5)
        };
        let ends = ends(pump, self.start, owed_ml, nearest, self.step_rad)?;
        Ok(ends.map(|end| end.map(|(steps, _)| booked(pump, self.turned, steps, self.step_rad))))
    }
}
