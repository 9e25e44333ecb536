//! A flow over time before it moves.

use pump_ctl::plan::{
    Cruise, FlowError, FlowKnot, FlowMotion, FlowPace, FlowPlan, Motor, Phase, PlannedMotion,
};
use pump_model::Pump;
use pump_model::units::{TURN_RAD, rpm};

use crate::bench::bench::Bench;
use crate::bench::delivery::Delivered;
use crate::bench::lateness::is_late;
use crate::bench::session::Session;
use crate::calibration::Stored;
use crate::dosing::{DoseError, DoseRequest, FlowProfile, FlowWayOut, Prepared, TubeLife};
use crate::drives::DriveError;
use crate::notice::Notice;
use crate::pump_file::PumpFile;
use crate::record::{PumpState, ShortText, Wear};

/// Rows between two looks whether the user asked to stop.
const ROWS_A_LOOK: usize = 64;

/// Most motor steps of a flow over time whose way out is looked for: a look takes some hundredths of a second.
const MOST_STEPS_TRIED: f64 = 300_000.0;

/// Flow over time that is planned and may run.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PreparedProfile {
    /// Plan of the volume at the flow at which most of it passes, with the predictions of the flow over time.
    pub whole: Prepared,
    /// Name of the profile.
    pub(crate) name: ShortText,
    knots: Vec<FlowKnot>,
    pace: FlowPace,
    motor: Motor,
}

impl PreparedProfile {
    /// Returns the name of the profile.
    pub fn name(&self) -> &str {
        self.name.as_str()
    }

    /// Returns the motion.
    pub fn motion(&self) -> FlowMotion<'_> {
        FlowMotion::new(&self.whole.model, self.motor, self.whole.plan.start(), &self.knots, self.pace)
    }

    /// Returns the volume of the planned steps once the line has settled, in mL.
    pub fn planned_ml(&self) -> f64 {
        let motion = self.motion();
        PlannedMotion::Flow(&motion).planned_ml(&self.whole.model)
    }

    /// Returns the volume of the first `count` steps once the line has settled, in mL.
    pub fn delivered_ml(&self, count: u64) -> f64 {
        let motion = self.motion();
        PlannedMotion::Flow(&motion).delivered_ml(&self.whole.model, count)
    }

    /// Returns the largest distance of the volume at the rollers from the profile's at any moment, in mL: that of a
    /// motor step where the flow per radian is largest.
    pub fn largest_departure_ml(&self) -> f64 {
        self.whole.model.outlet_curve().largest_flow_ml_rad() * self.motor.step_rad()
    }

    /// Returns that distance as it was kept, in mL. `None` for a run that was late or stopped: it left the profile.
    pub(crate) fn departure_kept_ml(&self, delivered: &Delivered) -> Option<f64> {
        let is_kept = delivered.completed && !is_late(self.motion().duration_s(), delivered.measured_s);
        is_kept.then(|| self.largest_departure_ml())
    }
}

impl Session<'_> {
    /// Plans a run that follows a flow over time, from the recorded angle and within the limits of the device, and
    /// predicts it. Moves nothing.
    ///
    /// # Errors
    ///
    /// [`DoseError::Flow`] or [`DoseError::SteepFlow`] with the first row or instant that cannot be met. Other
    /// [`DoseError`]s if a dose is unfinished or the device cannot be used.
    pub fn prepare_profile(
        &mut self,
        request: DoseRequest,
        profile: &FlowProfile,
    ) -> Result<PreparedProfile, DoseError> {
        self.check_stand()?;
        if self.cut_off.is_none() {
            self.finished()?;
        }
        self.check_confirmed()?;
        let bench = self.bench;
        self.connect_for(|file, state| bench.plan_profile(file, state, request, profile))?;
        let mut prepared = self.bench.plan_profile(self.file(), self.state, request, profile)?;
        self.keep_safe(prepared.planned_ml())?;
        prepared.whole = self.checked(prepared.whole)?;
        Ok(prepared)
    }
}

impl Bench {
    /// Plans a run that follows a flow over time, from the record. Moves and writes nothing, and does not ask the
    /// device.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as in [`Session::prepare_profile`].
    pub fn prepare_profile(
        &self,
        request: DoseRequest,
        profile: &FlowProfile,
    ) -> Result<PreparedProfile, DoseError> {
        let state = self.state_to_plan_from()?;
        let mut prepared = self.plan_profile(&self.file_for_dry_run()?, state, request, profile)?;
        self.would_be_safe(state.as_ref(), prepared.planned_ml())?;
        prepared.whole.warnings.extend(self.device_not_asked());
        prepared.whole.warnings.extend(self.confirmation_missing(state.as_ref()));
        Ok(prepared)
    }

    /// Plans a run that follows a flow over time as if `state` were on record. `file` is the pump file as the device
    /// allows it.
    pub(in crate::bench) fn plan_profile(
        &self,
        file: &PumpFile,
        state: Option<PumpState>,
        request: DoseRequest,
        profile: &FlowProfile,
    ) -> Result<PreparedProfile, DoseError> {
        let located = |error| match error {
            DoseError::Flow(refused) => DoseError::Flow(profile.located(refused)),
            DoseError::SteepFlow { way_out, source } => {
                DoseError::SteepFlow { way_out, source: profile.located(source) }
            }
            error => error,
        };
        let planned = self.plan_rows(file, state, request, profile);
        planned.map_err(|error| self.told_by_device(file, located(error)))
    }

    fn plan_rows(
        &self,
        file: &PumpFile,
        state: Option<PumpState>,
        request: DoseRequest,
        profile: &FlowProfile,
    ) -> Result<PreparedProfile, DoseError> {
        self.refuse_unfinished(state)?;
        if !self.identity().abilities.flow_over_time {
            return Err(DoseError::Connection(DriveError::no_flow(self.drive_id())));
        }
        if request.cruise.is_some()
            || request.smooth
            || request.ramps.is_some()
            || request.retract_ml.is_some()
        {
            return Err(DoseError::NoRun { why: "by a profile has neither a rate nor ramps of its own" });
        }
        profile.check().map_err(DoseError::Flow)?;
        let request = DoseRequest { volume_ml: profile.volume_ml(), asked: Some(profile.asked()), ..request };
        let limits = file.limits_with(request.pressures);
        let whole = match self.plan_for_flow(file, state, request, profile.main_flow_ml_s()) {
            // A flow that cannot be met is refused with its first instant.
            Err(refused @ (DoseError::Plan(_) | DoseError::Calibration(_))) => {
                let start = self.stands_for(state, &request, None).start;
                self.stepped(self.model(), limits.motor, start, profile)?;
                return Err(refused);
            }
            whole => whole?,
        };
        let (knots, pace) = self.stepped(&whole.model, limits.motor, whole.plan.start(), profile)?;
        let motor = limits.motor;
        let mut prepared = PreparedProfile { whole, name: profile.asked(), knots, pace, motor };
        let motion = prepared.motion();
        let (prediction, margins) =
            motion.predict(&prepared.whole.model, &limits).map_err(DoseError::Flow)?;
        let (back_flow, motion_s) = (motion.back_flow(&prepared.whole.model)?, motion.duration_s());
        let whole = &mut prepared.whole;
        (whole.prediction, whole.margins, whole.back_flow) = (prediction, margins, back_flow);
        let plan = &whole.plan;
        let revolutions = plan.steps().unsigned_abs() as f64 / plan.steps_per_rev();
        let planned = Wear { volume_ml: plan.planned_ml().abs(), revolutions, motion_s };
        let worn = state.map_or(Wear::default(), |state| state.wear);
        let tube = TubeLife::nearest(&self.file().tube, worn, planned);
        tube.map_or(Ok(()), |tube| tube.check())?;
        whole.warnings.extend(tube.and_then(|tube| tube.warning()));
        let peak_rpm = rpm(profile.largest_flow_ml_s() / whole.model.average_flow_ml_s(1.0).abs());
        if let Some(Stored { version, calibration }) = self.calibrations().active()? {
            let weighed = calibration.displacement.as_ref();
            let warning = weighed.and_then(|weighed| weighed.peak_warning(version, peak_rpm));
            whole.warnings.extend(warning.map(Notice::from));
        }
        Ok(prepared)
    }

    /// Plans the volume of a flow over time at the constant flow at which most of it passes.
    fn plan_for_flow(
        &self,
        file: &PumpFile,
        state: Option<PumpState>,
        request: DoseRequest,
        ml_s: f64,
    ) -> Result<Prepared, DoseError> {
        let stored = self.calibrations().active()?;
        let stands = self.stands_for(state, &request, stored.as_ref());
        let request = DoseRequest { cruise: Some(Cruise::Flow { ml_s }), ..request };
        Prepared::for_flow(file, self.model(), stored.as_ref(), request, stands)
    }

    /// Returns the knots of a profile's steps, or refuses the first instant that cannot be met, with the way out.
    fn stepped(
        &self,
        model: &Pump,
        motor: Motor,
        start: Phase,
        profile: &FlowProfile,
    ) -> Result<(Vec<FlowKnot>, FlowPace), DoseError> {
        let refused = match self.all_stepped(model, motor, start, profile) {
            Err(DoseError::Flow(
                source @ (FlowError::TooSteep { .. } | FlowError::TooFast { .. } | FlowError::Step { .. }),
            )) => source,
            ended => return ended,
        };
        // The way out of a long flow is not looked for: each look plans every step.
        let steps = profile.volume_ml().abs() / model.revolution_ml() * TURN_RAD / motor.step_rad();
        if steps > MOST_STEPS_TRIED {
            return Err(DoseError::Flow(refused));
        }
        let limit_rad_s2 = motor.max_acceleration_rad_s2;
        let way_out = FlowWayOut::find(profile.largest_flow_ml_s(), limit_rad_s2, |factor, times| {
            let mut motor = motor;
            motor.max_acceleration_rad_s2 = times * limit_rad_s2;
            self.all_stepped(model, motor, start, &profile.scaled(factor)).is_ok()
        });
        Err(DoseError::SteepFlow { way_out, source: refused })
    }

    /// Returns the knots of a profile's steps, or refuses the first instant that cannot be met.
    fn all_stepped(
        &self,
        model: &Pump,
        motor: Motor,
        start: Phase,
        profile: &FlowProfile,
    ) -> Result<(Vec<FlowKnot>, FlowPace), DoseError> {
        let mut plan = FlowPlan::new(model, motor, start).map_err(DoseError::Flow)?;
        let mut knots = Vec::with_capacity(profile.rows().len());
        for rows in profile.rows().chunks(ROWS_A_LOOK) {
            if self.opening().stop.is_made() {
                return Err(DoseError::Connection(DriveError::Interrupted));
            }
            for row in rows {
                plan.take(*row).map_err(DoseError::Flow)?;
                knots.extend(plan.knot());
            }
        }
        let pace = plan.end().map_err(DoseError::Flow)?;
        Ok((knots, pace))
    }
}
