//! A dose that is asked for, and the same planned and predicted.

use pump_ctl::plan::{
    Cruise, Finish, LimitedBy, Limits, Margin, Margins, Phase, Plan, PlanError, Prediction, Request,
};
use pump_model::Pump;
use pump_model::math::rpm;

use super::error::DoseError;
use super::planner::Planner;
use super::request::DoseRequest;
use super::retraction::Retraction;
use super::unknown_angle;
use crate::calibration::{Applied, Stored};
use crate::displacement::Correction;
use crate::pump_file::PumpFile;
use crate::record::{PhaseSource, Purpose, Terms};

/// A limit of which more than this is used is worth a warning.
const CLOSE: f64 = 0.95;

/// A smooth flow that keeps more than this part of the ripple is hardly one.
const HARDLY: f64 = 0.9;

/// A dose that is planned and may run.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    /// What was asked.
    pub request: DoseRequest,
    /// The pump that it was planned for: with its calibration or speed law at the dose's speed, if there is one.
    pub model: Pump,
    /// What these changed; none of a pump as its model is.
    pub applied: Option<Applied>,
    /// Steps and profile.
    pub plan: Plan,
    /// Pressures and settling.
    pub prediction: Prediction,
    /// What it was planned within.
    pub limits: Limits,
    /// How near it comes to that.
    pub margins: Margins,
    /// Where the start angle comes from.
    pub phase_source: PhaseSource,
    /// What the next dose owes afterwards, mL: the plan's carry, or what was on record before a prime or purge.
    pub carry_out_ml: f64,
    /// The way back after it.
    pub retraction: Option<Retraction>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl Prepared {
    /// Plans a dose of the pump of `file` from `start`, with `carry_ml` on record, and predicts it.
    pub fn new(
        file: &PumpFile,
        model: &Pump,
        request: DoseRequest,
        start: Phase,
        phase_source: PhaseSource,
        carry_ml: f64,
    ) -> Result<Self, DoseError> {
        Self::planned(file, model, None, request, start, phase_source, carry_ml)
    }

    /// The same of a pump with a calibration.
    pub fn calibrated(
        file: &PumpFile,
        model: &Pump,
        stored: &Stored,
        request: DoseRequest,
        start: Phase,
        phase_source: PhaseSource,
        carry_ml: f64,
    ) -> Result<Self, DoseError> {
        Self::planned(file, model, Some(stored), request, start, phase_source, carry_ml)
    }

    fn planned(
        file: &PumpFile,
        model: &Pump,
        stored: Option<&Stored>,
        request: DoseRequest,
        start: Phase,
        phase_source: PhaseSource,
        carry_ml: f64,
    ) -> Result<Self, DoseError> {
        let (asked, limits) = asked_of(file, &request, carry_ml);
        let law = match request.purpose {
            Purpose::Calibrate => None,
            _ => file.speed_law().map_err(PlanError::from)?,
        };
        let planner = Planner { file, base: model, stored, law, limits: &limits };
        let found = planner.plan(start, &asked)?;
        let mut prepared = Self::of_plan(
            file,
            request,
            found.model,
            found.applied,
            found.plan,
            limits,
            phase_source,
            carry_ml,
        )?;
        prepared.warnings.extend(found.warning);
        Ok(prepared)
    }

    #[allow(clippy::too_many_arguments, reason = "what a plan was made of")]
    fn of_plan(
        file: &PumpFile,
        request: DoseRequest,
        model: Pump,
        applied: Option<Applied>,
        plan: Plan,
        limits: Limits,
        phase_source: PhaseSource,
        carry_ml: f64,
    ) -> Result<Self, PlanError> {
        let prediction = plan.predict(&model)?;
        let margins = limits.margins(&model, &plan);
        let mut warnings = warnings_of(&model, &plan, &prediction, &margins)?;
        let is_weighed = applied.as_ref().is_some_and(|applied| applied.sureness().is_some());
        if file.is_estimated() && !is_weighed {
            warnings.push(
                "the roller volume is estimated from the drawing, not measured; weigh a dose before you rely on it"
                    .to_owned(),
            );
        }
        let mut prepared = Self {
            request,
            model,
            applied,
            plan,
            prediction,
            limits,
            margins,
            phase_source,
            carry_out_ml: if request.purpose == Purpose::Dose { plan.carry_ml } else { carry_ml },
            retraction: None,
            warnings,
        };
        if let Some(volume_ml) = request.retract_ml {
            prepared.retraction = Some(Retraction::new(&prepared, volume_ml)?);
        }
        Ok(prepared)
    }

    /// What its calibration or speed law changes of the pump.
    pub fn correction(&self) -> Correction {
        self.applied.as_ref().map_or(Correction::NONE, |applied| applied.correction)
    }

    /// The terms that the journal keeps for the rest of this dose, should it be cut off.
    pub(crate) fn terms(&self) -> Terms {
        let DoseRequest { smooth, finish, max_outlet_kpa, min_inlet_kpa, .. } = self.request;
        let cruise_rad_s = Some(self.plan.profile.cruise_rad_s());
        Terms { cruise_rad_s, smooth, low_flow: finish == Finish::LowFlow, max_outlet_kpa, min_inlet_kpa }
    }

    /// What the next dose owes once this one and its retraction are made, mL.
    pub fn owes_ml(&self) -> f64 {
        self.retraction.as_ref().map_or(self.carry_out_ml, |retraction| retraction.carry_out_ml)
    }
}

/// What is asked of the planner, and within which limits: the pump file's where the request names none.
fn asked_of(file: &PumpFile, request: &DoseRequest, carry_ml: f64) -> (Request, Limits) {
    let default_cruise = Cruise::Flow { ml_s: file.pump.default_rate_ml_s };
    let asked = Request {
        volume_ml: request.volume_ml,
        carry_in_ml: if request.purpose == Purpose::Dose { carry_ml } else { 0.0 },
        cruise: request.cruise.unwrap_or(default_cruise),
        smooth: request.smooth,
        finish: request.finish,
    };
    (asked, file.limits_with(request.max_outlet_kpa, request.min_inlet_kpa))
}

/// What a person should know of a plan before it runs.
fn warnings_of(
    model: &Pump,
    plan: &Plan,
    prediction: &Prediction,
    margins: &Margins,
) -> Result<Vec<String>, PlanError> {
    let mut warnings = Vec::new();
    if !plan.start.is_known(model.pitch_rad()) {
        warnings.extend(unknown_angle::warnings(model, plan));
    }
    if plan.limited_by == LimitedBy::Acceleration {
        warnings.push(format!(
            "the dose is too short to reach its cruise speed at {} rad/s2; it peaks at {:.4} r/min",
            plan.profile.acceleration_rad_s2(),
            rpm(plan.profile.peak_rad_s()),
        ));
    }
    let ripples = plan.ripples(model);
    if plan.is_smooth() && ripples.after.rms > HARDLY * ripples.before.rms {
        warnings.push(format!(
            "a smooth flow was asked for, but at this rate the motor has no room to follow it: {:.1} % of ripple (RMS) stay of \
             {:.1} %; a slower rate is smoother",
            100.0 * ripples.after.rms,
            100.0 * ripples.before.rms
        ));
    }
    if let Some(warning) = low_flow_warning(model, plan)? {
        warnings.push(warning);
    } else if plan.carry_ml.abs() > 0.05 * plan.requested_ml.abs() {
        warnings.push(format!(
            "a motor step is coarse for this dose: it gives {:.2} µL, and the other {:.2} µL are carried to the next",
            1e3 * plan.planned_ml,
            1e3 * plan.carry_ml
        ));
    }
    for (port, range) in [("inlet", prediction.inlet), ("outlet", prediction.outlet)] {
        if range.min_kpa < 0.0 {
            warnings.push(format!(
                "the {port} pressure would fall to {:.1} kPa absolute, which no liquid can: it would cavitate and the \
                 dose be short; lower the rate",
                range.min_kpa
            ));
        }
    }
    for (what, unit, margin) in [
        ("outlet pressure", "kPa", margins.outlet),
        ("inlet pressure", "kPa", margins.inlet),
        ("outlet pressure where the flow falls", "kPa", margins.outlet_suction),
        ("torque", "N m", margins.torque),
    ] {
        if let Some(Margin { reached, limit, used }) = margin
            && used > CLOSE
        {
            warnings.push(format!(
                "the {what} comes close to its limit: {reached:.4} of {limit:.4} {unit}, {:.1} % of the room from rest",
                100.0 * used
            ));
        }
    }
    if prediction.step_kpa > 1.0 {
        warnings.push(format!(
            "a single motor step moves the pressure by up to {:.1} kPa on top of what is predicted; use more microsteps",
            prediction.step_kpa
        ));
    }
    Ok(warnings)
}

/// What a dose that ends at low flow carries because of that, and what it need not.
fn low_flow_warning(model: &Pump, plan: &Plan) -> Result<Option<String>, PlanError> {
    // Within half a step of what was asked the end is where it would be anyway.
    let half_step_ml = 0.5 * plan.step_rad * model.nominal_ml_rad();
    if plan.finish == Finish::Any || plan.carry_ml.abs() <= half_step_ml {
        return Ok(None);
    }
    let volumes = plan.low_flow_volumes_ml(model)?.into_iter().flatten();
    let nearest: Vec<String> =
        volumes.map(|volume_ml| format!("{:.4} mL", volume_ml - plan.carry_in_ml)).collect();
    let word = if plan.carry_ml * plan.requested_ml < 0.0 { "too much" } else { "too little" };
    Ok(Some(format!(
        "to end at low flow the dose gives {:.4} mL for {} mL asked; {:.4} mL {word} are carried to the next; nearest volumes that \
         end there and carry nothing: {}",
        plan.planned_ml,
        plan.requested_ml,
        plan.carry_ml.abs(),
        nearest.join(" and ")
    )))
}
