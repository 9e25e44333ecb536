//! Retraction (suck-back): after a dose the pump turns back a little, so that nothing drips. The next dose
//! repays it.

use pump_ctl::Parameter;
use pump_ctl::plan::{Allowed, Cruise, Doser, Limits, Plan, PlanError, Prediction, Request};
use pump_model::{Leg, Pump};

use super::error::DoseError;
use super::prepared::Prepared;
use super::warnings;

/// Retraction that is planned and may run once its dose is delivered.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Retraction {
    /// Steps and profile of the way back.
    pub plan: Plan,
    /// Predicted pressures and settling of the way back.
    pub prediction: Prediction,
    /// Carry after the retraction, in mL: the carry of the dose and the volume sucked back.
    pub(crate) carry_out_ml: f64,
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

impl Prepared {
    /// Returns the legs of the dose and of its retraction, from the start of the dose on. The retraction
    /// starts once the line has settled. After the last leg the rotor stands.
    pub fn legs(&self) -> impl Iterator<Item = Leg> + Clone {
        let end_s = self.plan.profile().duration_s();
        let start_s = end_s + self.prediction.settle_s;
        let back = self.retraction.iter().flat_map(move |back| {
            let stands = Leg { duration_s: start_s - end_s, ..Leg::rest(end_s, self.plan.end_angle_rad()) };
            let later = move |leg: Leg| Leg { start_s: start_s + leg.start_s, ..leg };
            [stands].into_iter().chain(back.plan.legs().map(later))
        });
        self.plan.legs().chain(back)
    }

    /// Returns the time from the start of the dose to the last step, that of the retraction included, s.
    pub fn motion_s(&self) -> f64 {
        let dose_s = self.plan.profile().duration_s();
        let back_s = |back: &Retraction| self.prediction.settle_s + back.plan.profile().duration_s();
        dose_s + self.retraction.as_ref().map_or(0.0, back_s)
    }

    /// Returns the time from the start of the dose until the line has settled after the last step, that of
    /// the retraction included, s.
    pub fn settled_s(&self) -> f64 {
        let last = self.retraction.as_ref().map_or(&self.prediction, |back| &back.prediction);
        self.motion_s() + last.settle_s
    }
}

/// Refuses a volume that cannot be sucked back after a dose of `asked_ml`.
fn check(volume_ml: f64, asked_ml: f64) -> Result<(), PlanError> {
    if volume_ml > asked_ml && asked_ml > 0.0 {
        let allowed = Allowed::Words("no more than the dose: a dose of a negative volume runs back farther");
        return Err(PlanError::OutOfRange { parameter: Parameter::Retraction, value: volume_ml, allowed });
    }
    if volume_ml > 0.0 && asked_ml > 0.0 {
        return Ok(());
    }
    let (parameter, value, allowed) = if asked_ml > 0.0 {
        (Parameter::Retraction, volume_ml, "more than 0")
    } else {
        (Parameter::RetractedDose, asked_ml, "more than 0: a reverse dose leaves nothing to drip")
    };
    Err(PlanError::OutOfRange { parameter, value, allowed: Allowed::Words(allowed) })
}
