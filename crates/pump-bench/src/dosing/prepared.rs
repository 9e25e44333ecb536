//! A prepared dose: the request, planned and predicted.

mod less_back_flow;
mod stopped;

use pump_ctl::plan::{
    Cruise, Finish, Limits, Margins, Phase, Plan, PlanError, Prediction, PressureLimits, Request,
};
use pump_model::units::degrees;
use pump_model::{BackFlow, Pump};

pub(crate) use stopped::settle_of_s;

use super::displaced_pumps::DisplacedPumps;
use super::error::DoseError;
use super::planner::{Planner, SpeedPlan};
use super::request::{DoseRequest, RunBound, RunEnd};
use super::retraction::Retraction;
use super::ripple::unsure_smooth;
use super::stands::Stands;
use super::swept::Swept;
use super::uncertainty::Budget;
use super::uncertainty::outlet::drop_ml;
use super::warnings;
use crate::calibration::{Applied, CalibrationError, Stored, turned_ml};
use crate::displacement::{Correction, SpeedDependentPump};
use crate::notice::Notice;
use crate::pump_file::PumpFile;
use crate::record::{DoseTerms, PhaseSource, Purpose};

/// Most rounds in which a run to be weighed is slowed. Two are usual.
const MOST_ROUNDS: u32 = 20;

/// Dose that is planned and may run.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Prepared {
    /// Request that the dose was planned for.
    pub request: DoseRequest,
    /// Pump that the dose was planned for, corrected by its calibration or law at the dose's speed.
    pub model: Pump,
    /// Calibration and law that corrected the pump. `None` for a pump as its model is.
    pub(crate) applied: Option<Applied>,
    /// Steps and profile.
    pub plan: Plan,
    /// Predicted pressures and settling.
    pub prediction: Prediction,
    /// Volume that the line takes back from the vessel, before any retraction.
    pub back_flow: BackFlow,
    /// Volume of a drop that falls from the outlet's nozzle, in mL; 0 if the nozzle is immersed.
    pub drop_ml: f64,
    /// Limits that the dose was planned within.
    pub limits: Limits,
    /// Distances of the dose from its limits.
    pub margins: Margins,
    /// Source of the start angle.
    pub phase_source: PhaseSource,
    /// Carry after the dose, in mL: the plan's carry, or the carry on record before a prime or purge.
    pub carry_out_ml: f64,
    /// Half width of the range around the carry before the dose that holds the true carry, in mL, without the
    /// doses of the plan's `turned`.
    pub carry_half_width_ml: f64,
    /// Retraction after the dose.
    pub retraction: Option<Retraction>,
    /// Bound at which a run until it is stopped ends by itself. `None` for any other motion, and for the rest of such a
    /// run.
    pub(crate) ends_at: Option<RunBound>,
    /// Warnings for the user.
    pub warnings: Vec<Notice>,
}

/// Everything that a dose is planned from.
struct PlanningBasis<'a> {
    file: &'a PumpFile,
    /// Pump without calibration and law.
    model: &'a Pump,
    /// Calibration in use.
    stored: Option<&'a Stored>,
    request: DoseRequest,
    stands: Stands,
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
        Self::standing(file, model, None, request, Stands::at(start, phase_source, carry_ml))
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
        Self::standing(file, model, Some(stored), request, Stands::at(start, phase_source, carry_ml))
    }

    /// Plans and predicts a dose from the place `stands`.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as in [`Self::new`] and [`Self::calibrated`].
    pub(crate) fn standing(
        file: &PumpFile,
        model: &Pump,
        stored: Option<&Stored>,
        request: DoseRequest,
        stands: Stands,
    ) -> Result<Self, DoseError> {
        PlanningBasis { file, model, stored, request, stands }.prepare()
    }

    /// Plans the volume of a flow over time, at a constant flow and within the motor's limits alone. Pressures, torque
    /// and warnings of limits are those of the flow over time itself.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as in [`Self::calibrated`].
    pub(crate) fn for_flow(
        file: &PumpFile,
        model: &Pump,
        stored: Option<&Stored>,
        request: DoseRequest,
        stands: Stands,
    ) -> Result<Self, DoseError> {
        let basis = PlanningBasis { file, model, stored, request, stands };
        file.check_pressure_limits(request.pressures)?;
        let (asked, limits) = basis.asked();
        let motor = Limits::new(limits.motor);
        let pump = SpeedDependentPump::new(*model, file.displacement_law().map_err(PlanError::from)?);
        let planner = Planner { file, pump: &pump, stored, limits: &motor };
        let found = planner.plan(stands.start, &asked)?;
        let displaced = DisplacedPumps::only(found.model);
        let prepared = basis.predicted(found, &displaced, limits)?;
        let unweighed = prepared.applied.as_ref().and_then(|applied| applied.unweighed_speed.as_deref());
        let budget = || {
            prepared.budget(
                file,
                &Swept::whole(&prepared.model, &prepared.plan),
                prepared.back_flow.backflow_ml,
            )
        };
        let of_speed = unweighed.and_then(|text| warnings::unweighed_speed(text, &budget()));
        let of_calibration = warnings::of_calibration(file, prepared.applied.as_ref());
        let warnings = file.resistance_warning().into_iter().chain(of_calibration).chain(of_speed).collect();
        Ok(Self { warnings, ..prepared })
    }

    /// Returns the uncertainty budget of `part`, the part of the dose that was made or the whole. `file` is that of the
    /// dose's pump, and `backflow_ml` flows back at the end of the part.
    pub(crate) fn budget(&self, file: &PumpFile, part: &Swept, backflow_ml: f64) -> Budget {
        Budget::new(&self.model, part, &file.uncertainty, self.applied.as_ref())
            .with_default_pulse(file, &self.model, part, self.applied.as_ref())
            .with_outlet(file, self.drop_ml, backflow_ml)
            .with_carry_within(self.plan.carry_in_ml(), self.carry_in_within_ml())
    }

    /// Returns the correction of the displacement by the calibration or the law.
    pub(crate) fn correction(&self) -> Correction {
        self.applied.as_ref().map_or(Correction::NONE, |applied| applied.correction)
    }

    /// Returns the terms that the journal keeps for the rest of this dose, in case the dose is cut off.
    pub(crate) fn terms(&self, file: &PumpFile) -> DoseTerms {
        let DoseRequest { smooth, finish, ramps, pressures, .. } = self.request;
        let PressureLimits { max_outlet_kpa, min_inlet_kpa } = pressures;
        let low_flow = finish == Some(Finish::LowFlow);
        let cruise = cruise_of(&self.request, file);
        DoseTerms {
            smooth,
            low_flow,
            until_stopped: self.request.end == RunEnd::Stop,
            ramps,
            max_outlet_kpa,
            min_inlet_kpa,
            ..DoseTerms::cruising(cruise, self.plan.profile().cruise_rad_s())
        }
    }

    /// Returns the half width of the range around the carry that holds the true carry, in mL, once the rotor
    /// stands at `end_rad` after this dose and its retraction.
    pub(crate) fn carry_within_ml(&self, end_rad: f64) -> f64 {
        if !self.request.purpose.changes_carry() {
            return self.carry_half_width_ml;
        }
        let last = self.retraction.as_ref().map_or(&self.plan, |retraction| &retraction.plan);
        let turn_rad = end_rad - last.start().angle_rad();
        self.carry_half_width_ml + last.turned().by(turn_rad, turn_rad).half_width_ml(&self.model)
    }

    /// Returns the half width of the range around the carry before this dose that holds the true carry, in
    /// mL.
    ///
    /// From a stated angle earlier doses and this one are booked by that angle. The tolerance is then in this
    /// dose's own volume and not in its carry. A turn that was cut off is in the carry all the same.
    pub(crate) fn carry_in_within_ml(&self) -> f64 {
        if !self.request.purpose.changes_carry() {
            return self.carry_half_width_ml;
        }
        self.carry_half_width_ml + self.plan.turned().aimed().half_width_ml(&self.model)
    }

    /// Returns the carry once this dose and its retraction are made, in mL.
    pub fn owes_ml(&self) -> f64 {
        self.retraction.as_ref().map_or(self.carry_out_ml, |retraction| retraction.carry_out_ml)
    }
}

impl PlanningBasis<'_> {
    /// Plans the dose, then predicts it.
    fn prepare(&self) -> Result<Prepared, DoseError> {
        self.file.check_pressure_limits(self.request.pressures)?;
        let (asked, limits) = self.asked();
        if self.request.purpose == Purpose::Calibrate {
            return self.prepare_to_weigh(&asked, limits);
        }
        let found = self.planned(&asked)?;
        let displaced = DisplacedPumps::only(found.model);
        self.predicted(found, &displaced, limits)
    }

    /// Plans a dose, other than a run to be weighed.
    fn planned(&self, asked: &Request) -> Result<SpeedPlan, DoseError> {
        let Self { file, model: base, stored, .. } = *self;
        let limits = self.file.limits_with(self.request.pressures);
        let pump = SpeedDependentPump::new(*base, file.displacement_law().map_err(PlanError::from)?);
        let planner = Planner { file, pump: &pump, stored, limits: &limits };
        planner.plan(self.stands.start, asked)
    }

    /// Plans a run to be weighed: its steps are those of the model, and its limits hold by what the pump
    /// displaces. A run that is to be as fast as possible is slowed until they do.
    fn prepare_to_weigh(&self, asked: &Request, limits: Limits) -> Result<Prepared, DoseError> {
        let Self { file, model: base, stored, .. } = *self;
        let pump = SpeedDependentPump::constant(*base);
        let motor = Limits::new(limits.motor);
        let planner = Planner { file, pump: &pump, stored: None, limits: &motor };
        let mut found = planner.plan(self.stands.start, asked)?;
        let displaced = |plan: &Plan| {
            let speed_rad_s = plan.profile().cruise_rad_s() * f64::from(plan.direction().sign());
            DisplacedPumps::at(file, base, stored, speed_rad_s)
        };
        // At another speed the pump displaces another volume, so a slower run is checked anew.
        let mut rounds = if asked.cruise == Cruise::Fastest { MOST_ROUNDS } else { 0 };
        let pumps = loop {
            let pumps = displaced(&found.plan)?;
            match pumps.check(&found.plan, &limits) {
                Ok(()) => break pumps,
                Err(refused) if rounds == 0 => return Err(refused.into()),
                Err(_) => found.plan = pumps.fastest(&found.plan, &limits)?,
            }
            rounds -= 1;
        };
        check_weighable(base, &found.plan)?;
        self.predicted(found, &pumps, limits)
    }

    /// Returns the carry that the dose settles, in mL.
    fn carry_in_ml(&self) -> f64 {
        if self.request.purpose == Purpose::Dose { self.stands.carry_ml } else { 0.0 }
    }

    /// Returns the request to the planner, and the limits: the pump file's where the request names none.
    fn asked(&self) -> (Request, Limits) {
        let request = &self.request;
        let (volume_ml, carry_in_ml) = match self.stands.to_end_ml {
            Some(to_end_ml) => (to_end_ml, 0.0),
            None => (request.volume_ml, self.carry_in_ml()),
        };
        let asked = Request::new(volume_ml, cruise_of(request, self.file))
            .with_carry_in_ml(carry_in_ml)
            .with_smooth(request.smooth)
            .with_finish(request.finish.unwrap_or_default())
            .with_turned(self.stands.account.map(|account| account.turned))
            .with_ramps(request.ramps.unwrap_or(self.file.usual_ramps()));
        (asked, self.file.limits_with(request.pressures))
    }

    /// Returns the plan with the volumes that were asked for. The rest of a dose is planned to the end of the
    /// whole.
    fn as_asked(&self, plan: Plan) -> Plan {
        match self.stands.to_end_ml {
            Some(_) => plan.booked_as(self.request.volume_ml, self.carry_in_ml()),
            None => plan,
        }
    }

    /// Adds the prediction, the margins, the warnings and the retraction to a plan. The pressures are predicted by
    /// the pumps `displaced`.
    fn predicted(
        &self,
        found: SpeedPlan,
        displaced: &DisplacedPumps,
        limits: Limits,
    ) -> Result<Prepared, DoseError> {
        let SpeedPlan { model, plan, applied, warning } = found;
        let plan = self.as_asked(plan);
        let (file, request) = (self.file, self.request);
        let prediction = displaced.predict(&plan)?;
        let back_flow = displaced.back_flow(&plan)?;
        let margins = displaced.margins(&plan, &limits);
        let carry_out_ml = match request.purpose {
            Purpose::Dose => plan.carry_ml(),
            Purpose::Retract => self.stands.carry_ml - plan.planned_ml(),
            _ => self.stands.carry_ml,
        };
        let retraction = match request.retract_ml {
            Some(volume_ml) => {
                let asked_ml = request.whole_ml.unwrap_or(plan.requested_ml());
                Some(Retraction::new(&model, &plan, &limits, asked_ml, carry_out_ml, volume_ml)?)
            }
            None => None,
        };
        let correction = applied.as_ref().map_or(Correction::NONE, |applied| applied.correction);
        let changed_ml =
            self.stands.account.map_or(0.0, |account| account.changed_ml(&correction, self.model));
        let mut prepared = Prepared {
            request,
            model,
            applied,
            plan,
            prediction,
            back_flow,
            drop_ml: drop_ml(file).map_err(PlanError::from)?,
            limits,
            margins,
            phase_source: self.stands.source,
            carry_out_ml,
            carry_half_width_ml: self.stands.carry_half_width_ml + changed_ml,
            retraction,
            ends_at: None,
            warnings: Vec::new(),
        };
        prepared.warnings = self.warnings(&prepared, warning)?;
        Ok(prepared)
    }

    /// Returns the warnings of a prepared dose. `of_speed` is that of its speed.
    fn warnings(&self, prepared: &Prepared, of_speed: Option<String>) -> Result<Vec<Notice>, PlanError> {
        let Prepared { model, applied, plan, prediction, margins, retraction, .. } = prepared;
        let mut warnings = warnings::of_plan(model, plan, prediction, margins, self.request.purpose)?;
        if self.file.has_lines() {
            let wider = warnings::wider_inlet_swing(model, plan, prediction, prepared.limits.motor)?;
            warnings.extend(wider.map(Notice::from));
        }
        let budget =
            || prepared.budget(self.file, &Swept::whole(model, plan), prepared.back_flow.backflow_ml);
        if prepared.request.purpose == Purpose::Dose {
            let half_width_ml = prepared.carry_in_within_ml();
            warnings.extend(warnings::unsure_carry(plan.requested_ml(), plan.carry_in_ml(), half_width_ml));
            warnings.extend(self.back_flow_warning(prepared, &budget()));
            warnings.extend(warnings::unweighed_pump(self.file, applied.as_ref()));
        }
        warnings.extend(warnings::of_pump(self.file, applied.as_ref(), prediction, plan.direction()));
        warnings.extend(warnings::of_calibration(self.file, applied.as_ref()));
        let unweighed = applied.as_ref().and_then(|applied| applied.unweighed_speed.as_deref());
        warnings.extend(unweighed.and_then(|text| warnings::unweighed_speed(text, &budget())));
        let of_retraction = retraction.iter().flat_map(|retraction| retraction.warnings.clone());
        warnings.extend(of_speed.into_iter().chain(of_retraction).map(Notice::from));
        warnings.extend(unsure_smooth(self.file, model, plan, applied.as_ref()));
        Ok(warnings)
    }
}

/// Refuses a run to be weighed whose volume the model cannot tell: a part of a pitch from an unknown angle.
fn check_weighable(model: &Pump, plan: &Plan) -> Result<(), CalibrationError> {
    let known = plan.start().is_known(model.pitch_rad());
    let turned_deg = degrees(plan.steps() as f64 * plan.step_rad());
    let pitch_deg = degrees(model.pitch_rad());
    match turned_ml(model, known.then_some(degrees(plan.start().angle_rad())), turned_deg, 1) {
        Err(CalibrationError::UnknownAngle { .. }) => {
            Err(CalibrationError::PartOfPitch { turned_deg, pitch_deg })
        }
        told => told.map(drop),
    }
}

/// Returns the cruise that a request asks for: the pump file's default rate where it names none.
pub(crate) fn cruise_of(request: &DoseRequest, file: &PumpFile) -> Cruise {
    request.cruise.unwrap_or(Cruise::Flow { ml_s: file.pump.default_rate_ml_s })
}
