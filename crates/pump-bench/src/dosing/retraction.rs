//! Retraction (suck-back): after a dose the pump turns back a little, so that nothing drips. The next dose
//! repays it.

use pump_ctl::plan::{Allowed, Cruise, Doser, Limits, Plan, PlanError, Prediction, Request};
use pump_model::Pump;

use super::error::DoseError;
use super::warnings;

/// Retraction that is planned and may run once its dose is delivered.
#[derive(Debug, Clone, PartialEq)]
pub struct Retraction {
    /// Steps and profile of the way back.
    pub plan: Plan,
    /// Predicted pressures and settling of the way back.
    pub prediction: Prediction,
    /// Carry after the retraction, in mL: the carry of the dose and the volume sucked back.
    pub carry_out_ml: f64,
    /// Warnings of the way back.
    pub(super) warnings: Vec<String>,
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
    ) -> Result<Self, DoseError> {
        check(volume_ml, asked_ml)?;
        let stands = dose.start().moved_to(dose.end_angle_rad());
        let cruise = Cruise::Speed { rad_s: dose.profile().cruise_rad_s() };
        let turned = Some(dose.turned_after(dose.steps().unsigned_abs()));
        let turned = turned.filter(|turned| !turned.is_exact());
        let request = Request::new(-volume_ml, cruise).with_turned(turned).with_ramps(dose.ramps());
        let refused = |source| DoseError::SuckBack { volume_ml, source };
        let plan =
            Doser::new(model, *limits).and_then(|doser| doser.plan(stands, &request)).map_err(refused)?;
        let prediction = plan.predict(model).map_err(refused)?;
        let margins = limits.margins(model, &plan);
        let warnings = warnings::of_retraction(&prediction, &margins);
        Ok(Self { carry_out_ml: carry_ml - plan.planned_ml(), plan, prediction, warnings })
    }
}

/// Refuses a volume that cannot be sucked back after a dose of `asked_ml`.
fn check(volume_ml: f64, asked_ml: f64) -> Result<(), PlanError> {
    if volume_ml > asked_ml && asked_ml > 0.0 {
        let allowed = Allowed::Words("no more than the dose: `dose -5mL` runs back farther");
        return Err(PlanError::OutOfRange { parameter: "retraction in mL", value: volume_ml, allowed });
    }
    if volume_ml > 0.0 && asked_ml > 0.0 {
        return Ok(());
    }
    let (parameter, value, allowed) = if asked_ml > 0.0 {
        ("retraction in mL", volume_ml, "more than 0")
    } else {
        ("dose in mL before a retraction", asked_ml, "more than 0: a reverse dose leaves nothing to drip")
    };
    Err(PlanError::OutOfRange { parameter, value, allowed: Allowed::Words(allowed) })
}
