//! A series of motions that is checked as a whole before the first one begins.

use std::ops::ControlFlow;

use pump_ctl::plan::{Plan, PlannedMotion};

use crate::bench::bench::Bench;
use crate::bench::by_profile::PreparedProfile;
use crate::bench::delivery::Delivered;
use crate::bench::session::Session;
use crate::dosing::{DoseError, DoseRequest, FlowProfile, Prepared};
use crate::drives::BoardShare;
use crate::notice::Notice;
use crate::pump_file::PumpFile;
use crate::record::{Intent, PumpState, Purpose};

/// Request for a motion of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesRequest {
    /// Request for a dose, or the terms of a flow over time.
    pub request: DoseRequest,
    /// Flow over time that the motion follows. `None` for a dose.
    pub profile: Option<FlowProfile>,
}

/// Motion of a series that is planned and may run.
#[derive(Debug, Clone, PartialEq)]
pub enum SeriesMotion {
    /// Dose.
    Dose(Box<Prepared>),
    /// Flow over time.
    Flow(Box<PreparedProfile>),
}

impl SeriesMotion {
    /// Returns the dose, or the volume of the flow over time as a dose.
    pub fn whole(&self) -> &Prepared {
        match self {
            Self::Dose(prepared) => prepared,
            Self::Flow(prepared) => &prepared.whole,
        }
    }

    /// Returns the planned volume, in mL. Negative in reverse.
    pub fn planned_ml(&self) -> f64 {
        match self {
            Self::Dose(prepared) => prepared.plan.planned_ml(),
            Self::Flow(prepared) => prepared.planned_ml(),
        }
    }

    /// Returns the number of motor steps, without their sign.
    pub fn steps(&self) -> u64 {
        self.with_motion(|motion| motion.steps().unsigned_abs())
    }

    /// Returns the time of motor step `number`, in s since the start.
    pub fn time_of(&self, number: u64) -> f64 {
        self.with_motion(|motion| motion.time_of(number))
    }

    /// Returns the time of the motion, in s.
    pub fn motion_s(&self) -> f64 {
        match self {
            Self::Dose(prepared) => prepared.plan.profile().duration_s(),
            Self::Flow(prepared) => prepared.motion().duration_s(),
        }
    }

    /// Returns the angle of all steps, in rad, positive.
    pub fn turn_rad(&self) -> f64 {
        self.steps() as f64 * self.whole().plan.step_rad()
    }

    /// Returns the fastest speed, in rad/s. That of a flow over time is its mean.
    pub fn peak_rad_s(&self) -> f64 {
        match self {
            Self::Dose(prepared) => prepared.plan.profile().peak_rad_s(),
            Self::Flow(_) => self.turn_rad() / self.motion_s(),
        }
    }

    /// Adds warnings for the user.
    pub(crate) fn warn(&mut self, mut warnings: Vec<Notice>) {
        self.whole_mut().warnings.append(&mut warnings);
    }

    /// Returns the volume of the first `made` steps, in mL, by the model.
    pub fn delivered_ml(&self, made: u64) -> f64 {
        self.with_motion(|motion| motion.delivered_ml(&self.whole().model, made))
    }

    /// Returns the angle of the rollers after the first `made` steps, in rad.
    pub fn angle_after(&self, made: u64) -> f64 {
        self.with_motion(|motion| motion.angle_after(made))
    }

    fn whole_mut(&mut self) -> &mut Prepared {
        match self {
            Self::Dose(prepared) => prepared,
            Self::Flow(prepared) => &mut prepared.whole,
        }
    }

    fn with_motion<T>(&self, of: impl FnOnce(PlannedMotion<'_>) -> T) -> T {
        match self {
            Self::Dose(prepared) => of((&prepared.plan).into()),
            Self::Flow(prepared) => of((&prepared.motion()).into()),
        }
    }
}

impl Session<'_> {
    /// Returns the part of its board that a motion takes. `None` for a device that makes it whatever other axes do.
    ///
    /// # Errors
    ///
    /// [`DoseError::Connection`] if the board cannot make the motion.
    pub(crate) fn board_share(&self, motion: &SeriesMotion) -> Result<Option<BoardShare>, DoseError> {
        let Some(device) = &self.device else { return Ok(None) };
        motion.with_motion(|motion| device.drive.board_share(motion)).map_err(DoseError::Connection)
    }

    /// Returns the time from the leave for the first steps of a motion to the first of them, in s.
    pub(crate) fn begin_lead_s(&self) -> f64 {
        let of_device_s = self.device.as_ref().map_or(0.0, |device| device.drive.begin_lead_s());
        self.place.as_ref().map_or(of_device_s, |place| of_device_s.max(place.lead_s()))
    }

    /// Plans a series of motions, each from where the one before would leave the pump, within the limits of the
    /// device. Moves nothing. The notes of the device stay in the session. The safety limits are
    /// [`Session::keep_series_safe`]'s.
    ///
    /// # Errors
    ///
    /// [`DoseError`] of the first motion that cannot be planned, with its place in the series, from 0.
    pub fn prepare_series(
        &mut self,
        requests: &[SeriesRequest],
    ) -> Result<Vec<SeriesMotion>, (usize, DoseError)> {
        let first = |error| (0, error);
        self.check_stand().map_err(first)?;
        if self.cut_off.is_none() {
            self.finished().map_err(first)?;
        }
        self.check_confirmed().map_err(first)?;
        let (bench, mut place) = (self.bench, 0);
        let by_record = |file: &PumpFile, state| {
            bench.plan_series(file, state, requests).map_err(|(at, error)| {
                place = at;
                error
            })
        };
        self.connect_for(by_record).map_err(|error| (place, error))?;
        self.finished().map_err(first)?;
        let mut motions = self.bench.plan_series(self.file(), self.state, requests)?;
        // The notes stay for whoever runs the series, which may be planned again.
        let notes = std::mem::take(&mut self.notes);
        for (place, motion) in motions.iter_mut().enumerate() {
            let checked = self.checked(motion.whole().clone()).map_err(|error| (place, error))?;
            *motion.whole_mut() = checked;
        }
        self.notes = notes;
        Ok(motions)
    }

    /// Plans one motion of a series from where the rotor stands.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as for [`Session::prepare`] and [`Session::prepare_profile`].
    pub fn prepare_motion(&mut self, asked: &SeriesRequest) -> Result<SeriesMotion, DoseError> {
        Ok(match &asked.profile {
            None => SeriesMotion::Dose(Box::new(self.prepare(asked.request)?)),
            Some(profile) => SeriesMotion::Flow(Box::new(self.prepare_profile(asked.request, profile)?)),
        })
    }

    /// Runs a motion of a series, and records its end.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as for [`Session::run`] and [`Session::run_profile`].
    pub fn run_motion(
        &mut self,
        motion: &SeriesMotion,
        watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Delivered, DoseError> {
        match motion {
            SeriesMotion::Dose(prepared) => self.run(prepared, watch),
            SeriesMotion::Flow(prepared) => self.run_profile(prepared, watch),
        }
    }
}

impl Bench {
    /// Plans a series of motions from the record, as [`Session::prepare_series`] does. Moves and writes nothing, and
    /// does not ask the device.
    ///
    /// # Errors
    ///
    /// [`DoseError`] of the first motion that cannot be planned, with its place in the series, from 0.
    pub fn prepare_series(
        &self,
        requests: &[SeriesRequest],
    ) -> Result<Vec<SeriesMotion>, (usize, DoseError)> {
        let first = |error| (0, error);
        let state = self.state_to_plan_from().map_err(first)?;
        self.refuse_unfinished(state).map_err(first)?;
        let file = self.file_for_dry_run().map_err(first)?;
        let mut motions = self.plan_at_some_angle(state, |state| self.plan_series(&file, state, requests))?;
        if let Some(motion) = motions.first_mut() {
            let whole = motion.whole_mut();
            whole.warnings.extend(self.device_not_asked());
            whole.warnings.extend(self.confirmation_missing(state.as_ref()));
        }
        Ok(motions)
    }

    fn plan_series(
        &self,
        file: &PumpFile,
        mut state: Option<PumpState>,
        requests: &[SeriesRequest],
    ) -> Result<Vec<SeriesMotion>, (usize, DoseError)> {
        let planned = |(place, asked): (usize, &SeriesRequest)| {
            let motion = self.plan_motion(file, state, asked).map_err(|error| (place, error))?;
            state = Some(match &motion {
                SeriesMotion::Dose(prepared) => self.after_motion(state, prepared, asked.request.purpose),
                SeriesMotion::Flow(prepared) => self.after_flow(state, prepared),
            });
            Ok(motion)
        };
        requests.iter().enumerate().map(planned).collect()
    }

    fn plan_motion(
        &self,
        file: &PumpFile,
        state: Option<PumpState>,
        asked: &SeriesRequest,
    ) -> Result<SeriesMotion, DoseError> {
        Ok(match &asked.profile {
            None => SeriesMotion::Dose(Box::new(self.prepare_from(file, state, asked.request, None)?)),
            Some(profile) => {
                SeriesMotion::Flow(Box::new(self.plan_profile(file, state, asked.request, profile)?))
            }
        })
    }

    /// Returns the state of the pump once a flow over time has passed as planned.
    fn after_flow(&self, before: Option<PumpState>, prepared: &PreparedProfile) -> PumpState {
        let (flow, whole) = (prepared.motion(), &prepared.whole);
        let intent = Intent::of_flow(&flow, prepared.planned_ml(), whole.correction(), whole.carry_out_ml, 0);
        let all = flow.steps().abs();
        before.unwrap_or(self.fresh()).after_until(intent.unix_s, &intent, all, all, self.model())
    }

    /// Returns the state of the pump once `prepared` is delivered as planned, with its retraction.
    pub(in crate::bench) fn after_motion(
        &self,
        before: Option<PumpState>,
        prepared: &Prepared,
        purpose: Purpose,
    ) -> PumpState {
        let correction = prepared.correction();
        let made = |before: PumpState, plan: &Plan, purpose, carry_out_ml| {
            let intent = Intent::of(plan, correction, purpose, carry_out_ml, 0);
            let all = plan.steps().abs();
            before.after_until(intent.unix_s, &intent, all, all, self.model())
        };
        let state = made(before.unwrap_or(self.fresh()), &prepared.plan, purpose, prepared.carry_out_ml);
        match &prepared.retraction {
            Some(back) => made(state, &back.plan, Purpose::Retract, back.carry_out_ml),
            None => state,
        }
    }
}
