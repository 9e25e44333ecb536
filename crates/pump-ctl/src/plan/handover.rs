//! The angle and the carry that a dose hands on to the next.

use pump_model::Pump;

use super::Plan;
use super::words::Phase;

/// The angle and the carry that a dose hands on to the next. Both outlive a loss of power only where they are
/// stored.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Handover {
    /// Angle at which the rollers stand.
    pub phase: Phase,
    /// Volume that is still to be delivered, mL: the carry of a complete dose, the missing volume of a dose
    /// that was stopped.
    pub carry_ml: f64,
}

impl Plan {
    /// Returns the angle and the carry after `made` steps of this plan, all of them or not.
    ///
    /// ```
    /// use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request};
    ///
    /// let pump = pump_model::Pump::three_roller();
    /// let motor = Motor::new(12_800.0, 17.8, 500.0);
    /// let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
    /// let doser = Doser::new(&pump, Limits::new(motor))?;
    /// let dose = doser.plan(Phase::known(0.3), &request)?;
    /// let complete = dose.after(&pump, dose.steps().unsigned_abs());
    /// assert!((complete.carry_ml - dose.carry_ml()).abs() < 1e-9);
    /// // A dose that was stopped after 9000 steps is planned anew from there.
    /// let stopped = dose.after(&pump, 9000);
    /// let rest = Request::new(stopped.carry_ml, Cruise::Flow { ml_s: 5.0 });
    /// let rest = doser.plan(stopped.phase, &rest)?;
    /// assert_eq!(9000 + rest.steps(), dose.steps());
    /// # Ok::<(), pump_ctl::plan::PlanError>(())
    /// ```
    pub fn after(&self, pump: &Pump, made: u64) -> Handover {
        Handover {
            phase: self.start.moved_to(self.angle_after(made)),
            carry_ml: self.requested_ml + self.carry_in_ml - self.delivered_ml(pump, made),
        }
    }
}
