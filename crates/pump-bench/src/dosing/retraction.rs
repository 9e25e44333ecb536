//! Retraction (suck-back): after a dose the pump turns back by a little, so that nothing drips. The next dose repays it.

use pump_ctl::plan::{Allowed, Cruise, Phase, Plan, PlanError, Prediction, Request, plan};

use crate::dosing::Prepared;

/// A retraction that is planned and may run once its dose is delivered.
#[derive(Debug, Clone, PartialEq)]
pub struct Retraction {
    /// The way back.
    pub plan: Plan,
    /// Its pressures and settling.
    pub prediction: Prediction,
    /// What the next dose owes after it, mL: what the dose itself left, and what was sucked back.
    pub carry_out_ml: f64,
}

impl Retraction {
    /// Plans the way back by `volume_ml` (positive) from where `dose` ends, at the dose's own speed and with its
    /// calibration there.
    pub(crate) fn new(dose: &Prepared, volume_ml: f64) -> Result<Self, PlanError> {
        let (model, asked) = (&dose.model, dose.request.whole_ml.unwrap_or(dose.plan.requested_ml));
        if volume_ml > asked && asked > 0.0 {
            let allowed = Allowed::Words("no more than the dose: `dose -5mL` runs back farther");
            return Err(PlanError::OutOfRange { parameter: "retraction in mL", value: volume_ml, allowed });
        }
        if !(volume_ml > 0.0 && asked > 0.0) {
            let (parameter, value, allowed) = if asked > 0.0 {
                ("retraction in mL", volume_ml, "more than 0")
            } else {
                (
                    "dose in mL before a retraction",
                    asked,
                    "more than 0: a reverse dose leaves nothing to drip",
                )
            };
            return Err(PlanError::OutOfRange { parameter, value, allowed: Allowed::Words(allowed) });
        }
        let stands = Phase { angle_rad: dose.plan.end_angle_rad(), ..dose.plan.start };
        let cruise = Cruise::Speed { rad_s: dose.plan.profile.cruise_rad_s() };
        let plan = plan(model, stands, &Request::new(-volume_ml, cruise), &dose.limits)?;
        let prediction = plan.predict(model)?;
        Ok(Self { plan, prediction, carry_out_ml: dose.carry_out_ml - plan.planned_ml })
    }
}
