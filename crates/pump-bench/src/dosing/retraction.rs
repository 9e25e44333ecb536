//! Retraction (suck-back): after a dose the pump turns back a little, so that nothing drips. The next dose
//! repays it.

use pump_ctl::plan::{Allowed, Cruise, Limits, Phase, Plan, PlanError, Prediction, Request, plan};
use pump_model::Pump;

/// Retraction that is planned and may run once its dose is delivered.
#[derive(Debug, Clone, PartialEq)]
pub struct Retraction {
    /// Steps and profile of the way back.
    pub plan: Plan,
    /// Predicted pressures and settling of the way back.
    pub prediction: Prediction,
    /// Carry after the retraction, in mL: the carry of the dose and the volume sucked back.
    pub carry_out_ml: f64,
}

impl Retraction {
    /// Plans the way back by `volume_ml` (positive) from the end of `dose`, at the dose's own cruise speed.
    ///
    /// `model` is the pump as corrected for the dose. `asked_ml` is the volume asked for in all, and
    /// `carry_ml` is the carry after the dose.
    pub(super) fn new(
        model: &Pump,
        dose: &Plan,
        limits: &Limits,
        asked_ml: f64,
        carry_ml: f64,
        volume_ml: f64,
    ) -> Result<Self, PlanError> {
        if volume_ml > asked_ml && asked_ml > 0.0 {
            let allowed = Allowed::Words("no more than the dose: `dose -5mL` runs back farther");
            return Err(PlanError::OutOfRange { parameter: "retraction in mL", value: volume_ml, allowed });
        }
        if !(volume_ml > 0.0 && asked_ml > 0.0) {
            let (parameter, value, allowed) = if asked_ml > 0.0 {
                ("retraction in mL", volume_ml, "more than 0")
            } else {
                (
                    "dose in mL before a retraction",
                    asked_ml,
                    "more than 0: a reverse dose leaves nothing to drip",
                )
            };
            return Err(PlanError::OutOfRange { parameter, value, allowed: Allowed::Words(allowed) });
        }
        let stands = Phase { angle_rad: dose.end_angle_rad(), ..dose.start };
        let cruise = Cruise::Speed { rad_s: dose.profile.cruise_rad_s() };
        let plan = plan(model, stands, &Request::new(-volume_ml, cruise), limits)?;
        let prediction = plan.predict(model)?;
        Ok(Self { plan, prediction, carry_out_ml: carry_ml - plan.planned_ml })
    }
}
