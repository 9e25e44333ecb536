//! A prepared dose: the request, planned and predicted.

use pump_ctl::plan::{
    Cruise, Finish, Limits, Margins, Phase, Plan, PlanError, Prediction, PressureLimits, Request,
};
use pump_model::Pump;

use super::error::DoseError;
use super::planner::{Planner, SpeedPlan};
use super::request::DoseRequest;
use super::retraction::Retraction;
use super::warnings;
use crate::calibration::{Applied, Stored};
use crate::displacement::Correction;
use crate::pump_file::PumpFile;
use crate::record::{PhaseSource, Purpose, Terms};

/// Dose that is planned and may run.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    /// Request that the dose was planned for.
    pub request: DoseRequest,
    /// Pump that the dose was planned for, corrected by its calibration or speed law at the dose's speed.
    pub model: Pump,
    /// Calibration and speed law that corrected the pump. `None` for a pump as its model is.
    pub applied: Option<Applied>,
    /// Steps and profile.
    pub plan: Plan,
    /// Predicted pressures and settling.
    pub prediction: Prediction,
    /// Limits that the dose was planned within.
    pub limits: Limits,
    /// Distances of the dose from its limits.
    pub margins: Margins,
    /// Source of the start angle.
    pub phase_source: PhaseSource,
    /// Carry after the dose, in mL: the plan's carry, or the carry on record before a prime or purge.
    pub carry_out_ml: f64,
    /// Retraction after the dose.
    pub retraction: Option<Retraction>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// Everything that a dose is planned from.
struct Basis<'a> {
    file: &'a PumpFile,
    /// Pump without calibration and speed law.
    model: &'a Pump,
    /// Calibration in use.
    stored: Option<&'a Stored>,
    request: DoseRequest,
    start: Phase,
    phase_source: PhaseSource,
    /// Carry on record, in mL.
    carry_ml: f64,
}

impl Prepared {
    /// Plans and predicts a dose of the pump of `file` from `start`, with a carry of `carry_ml` on record.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if a value of the request is out of range, or the dose cannot keep the pump's limits.
    pub fn new(
        file: &PumpFile,
        model: &Pump,
        request: DoseRequest,
        start: Phase,
        phase_source: PhaseSource,
        carry_ml: f64,
    ) -> Result<Self, DoseError> {
        Basis { file, model, stored: None, request, start, phase_source, carry_ml }.prepare()
    }

    /// Plans and predicts a dose of a calibrated pump from `start`, with a carry of `carry_ml` on record.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if a value of the request is out of range, or the dose cannot keep the pump's limits.
    /// [`DoseError::Calibration`] if the calibration does not hold for the pump or the speed.
    pub fn calibrated(
        file: &PumpFile,
        model: &Pump,
        stored: &Stored,
        request: DoseRequest,
        start: Phase,
        phase_source: PhaseSource,
        carry_ml: f64,
    ) -> Result<Self, DoseError> {
        Basis { file, model, stored: Some(stored), request, start, phase_source, carry_ml }.prepare()
    }

    /// Returns the correction of the displacement by the calibration or the speed law.
    pub fn correction(&self) -> Correction {
        self.applied.as_ref().map_or(Correction::NONE, |applied| applied.correction)
    }

    /// Returns the terms that the journal keeps for the rest of this dose, in case the dose is cut off.
    pub(crate) fn terms(&self) -> Terms {
        let DoseRequest { smooth, finish, pressures, .. } = self.request;
        let PressureLimits { max_outlet_kpa, min_inlet_kpa } = pressures;
        let cruise_rad_s = Some(self.plan.profile.cruise_rad_s());
        Terms { cruise_rad_s, smooth, low_flow: finish == Finish::LowFlow, max_outlet_kpa, min_inlet_kpa }
    }

    /// Returns the carry once this dose and its retraction are made, in mL.
    pub fn owes_ml(&self) -> f64 {
        self.retraction.as_ref().map_or(self.carry_out_ml, |retraction| retraction.carry_out_ml)
    }
}

impl Basis<'_> {
    /// Plans the dose, then predicts it.
    fn prepare(&self) -> Result<Prepared, DoseError> {
        let (asked, limits) = self.asked();
        let law = match self.request.purpose {
            Purpose::Calibrate => None,
            _ => self.file.speed_law().map_err(PlanError::from)?,
        };
        let Self { file, model: base, stored, .. } = *self;
        let planner = Planner { file, base, stored, law, limits: &limits };
        let found = planner.plan(self.start, &asked)?;
        Ok(self.predicted(found, limits)?)
    }

    /// Returns the request to the planner, and the limits: the pump file's where the request names none.
    fn asked(&self) -> (Request, Limits) {
        let request = &self.request;
        let default_cruise = Cruise::Flow { ml_s: self.file.pump.default_rate_ml_s };
        let asked = Request {
            volume_ml: request.volume_ml,
            carry_in_ml: if request.purpose == Purpose::Dose { self.carry_ml } else { 0.0 },
            cruise: request.cruise.unwrap_or(default_cruise),
            smooth: request.smooth,
            finish: request.finish,
        };
        (asked, self.file.limits_with(request.pressures))
    }

    /// Adds the prediction, the margins, the warnings and the retraction to a plan.
    fn predicted(&self, found: SpeedPlan, limits: Limits) -> Result<Prepared, PlanError> {
        let SpeedPlan { model, plan, applied, warning } = found;
        let request = self.request;
        let prediction = plan.predict(&model)?;
        let margins = limits.margins(&model, &plan);
        let mut warnings = warnings::of_plan(&model, &plan, &prediction, &margins)?;
        warnings.extend(warnings::estimated_pump(self.file, applied.as_ref()));
        warnings.extend(warning);
        let carry_out_ml = if request.purpose == Purpose::Dose { plan.carry_ml } else { self.carry_ml };
        let retraction = match request.retract_ml {
            Some(volume_ml) => {
                let asked_ml = request.whole_ml.unwrap_or(plan.requested_ml);
                Some(Retraction::new(&model, &plan, &limits, asked_ml, carry_out_ml, volume_ml)?)
            }
            None => None,
        };
        Ok(Prepared {
            request,
            model,
            applied,
            plan,
            prediction,
            limits,
            margins,
            phase_source: self.phase_source,
            carry_out_ml,
            retraction,
            warnings,
        })
    }
}
