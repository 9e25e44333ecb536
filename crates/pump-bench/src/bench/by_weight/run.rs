//! A dose by weight under way: stretch after stretch, each weighed.

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_ctl::plan::Cruise;

use super::aim::Next;
use super::at_rest::at_rest;
use super::course::{Course, Stretch, StretchEnd};
use super::delivered::DeliveredByWeight;
use super::lookout::{Lookout, Stop};
use super::prepared::PreparedByWeight;
use super::readings::{Readings, Sample};
use crate::balance::{Balance, BalanceError, BalanceReading};
use crate::bench::recorded_motion::RecordedMotion;
use crate::bench::session::Session;
use crate::dosing::{DoseError, DoseRequest, WeightFault};
use crate::drives::{DriveError, StopRequest};
use crate::notice::with_sources;
use crate::record::{DoseTerms, LastDose, LogEnd, PumpState, Purpose, Stamp, Why};

/// Most stretches of a dose. A stretch leaves a few percent of what was missing, and drops take a few more.
const MOST_STRETCHES: u32 = 30;

/// Least time from the motor's last step to a reading at rest. A balance may call itself still before the last drop has
/// fallen.
const FALLEN_AFTER: Duration = Duration::from_millis(800);

/// Steps beyond the ceiling to which the journal's announced plan leads. They are never made: the dose stays unfinished
/// until the balance ends it.
const BEYOND_CEILING: f64 = 16.0;

impl Session<'_> {
    /// Reads the balance before a dose that it ends. Moves nothing. The vessel stands on the balance with whatever it
    /// holds.
    ///
    /// # Errors
    ///
    /// [`DoseError::Balance`] if the balance cannot be read. [`DoseError::NotByWeight`] if the dose is too small for
    /// it.
    /// [`DoseError::Connection`] if the user stops it, or the device cannot be used.
    pub fn tare_by_weight(
        &mut self,
        prepared: &PreparedByWeight,
        balance: &mut dyn Balance,
    ) -> Result<BalanceReading, DoseError> {
        self.finished()?;
        self.connect()?;
        let tare = self.reading_at_rest(balance, prepared.order.longest)?;
        let aim = Course::begin(prepared, tare, None).aim;
        if aim.target_ml <= aim.tolerance_ml() {
            return Err(DoseError::NotByWeight {
                why: format!("needs more than {}: it comes no nearer", aim.tolerance()),
                volume_ml: aim.target_ml,
            });
        }
        Ok(tare)
    }

    /// Reads the balance before the motor moves.
    pub(super) fn reading_at_rest(
        &self,
        balance: &mut dyn Balance,
        longest: Duration,
    ) -> Result<BalanceReading, DoseError> {
        let stop = self.bench.opening().stop.clone();
        at_rest(balance, longest, &stop, self.bench.is_simulated()).map_err(|error| match error {
            BalanceError::Stopped => DoseError::Connection(DriveError::Interrupted),
            error => DoseError::Balance(error),
        })
    }

    /// Makes a dose that `balance` ends, and records its end. The balance is read first, as
    /// [`Self::tare_by_weight`] does.
    ///
    /// # Errors
    ///
    /// Those of [`Self::tare_by_weight`] and [`Self::run_from_tare`].
    pub fn run_by_weight(
        &mut self,
        prepared: &PreparedByWeight,
        balance: &mut dyn Balance,
        watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<DeliveredByWeight, DoseError> {
        let tare = self.tare_by_weight(prepared, balance)?;
        self.run_from_tare(prepared, tare, balance, watch)
    }

    /// Makes a dose that `balance` ends, or the rest of one, and records its end. `tare` is what the balance shows
    /// before the motion: the reading of [`Self::tare_by_weight`] or of [`Self::prepare_rest_by_weight`].
    ///
    /// `watch` is called now and then with the steps of the stretch under way. When it breaks, the motor decelerates
    /// and holds, and the dose stays unfinished. A simulated motor takes no time, so no reading follows it: each of its
    /// stretches is weighed at its end.
    ///
    /// # Errors
    ///
    /// [`DoseError::ByWeight`] if the dose was stopped before the balance showed what was asked for: it is then
    /// unfinished on record. Other [`DoseError`]s if the device cannot be used or fails, or the dose cannot be
    /// recorded.
    pub fn run_from_tare(
        &mut self,
        prepared: &PreparedByWeight,
        tare: BalanceReading,
        balance: &mut dyn Balance,
        watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<DeliveredByWeight, DoseError> {
        if prepared.begun.is_none() {
            self.finished()?;
        } else if self.stands().unfinished.is_none() {
            return Err(DoseError::NothingUnfinished("resume"));
        }
        self.connect()?;
        self.keep_safe(prepared.most_ml - prepared.begun.map_or(0.0, |begun| begun.turned_ml))?;
        let began = self.log.clock.now();
        let ended = self.weigh_out(began, prepared, tare, balance, watch);
        match &ended {
            Ok(delivered) if delivered.completed => {}
            Ok(_) => self.log_broken_off(began, LogEnd::Stopped, None),
            Err(error) => self.log_broken_off(began, LogEnd::Fault, Some(with_sources(error))),
        }
        ended.map(|delivered| DeliveredByWeight { began: Some(began), ..delivered })
    }

    /// Makes the stretches of a dose that began at `began`.
    fn weigh_out(
        &mut self,
        began: Stamp,
        prepared: &PreparedByWeight,
        tare: BalanceReading,
        balance: &mut dyn Balance,
        mut watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<DeliveredByWeight, DoseError> {
        let user_stop = self.bench.opening().stop.clone();
        let simulated = self.bench.is_simulated();
        let longest = prepared.order.longest;
        let mut course = Course::begin(prepared, tare, self.stands().after_stop);
        if !simulated {
            course.reckoned_s = Some(course.reckoned());
        }
        loop {
            let next = course.next();
            let next = next.map_err(|fault| course.fault(fault, course.shown_g))?;
            let Next::Turn { volume_ml, slowly } = next else { break };
            if course.stretches == MOST_STRETCHES {
                let rest_ml = course.aim.target_ml - course.weighed_ml();
                let fault = WeightFault::Endless { stretches: course.stretches, rest_ml };
                return Err(course.fault(fault, course.shown_g));
            }
            let stretch = self.plan_stretch(&course, volume_ml, slowly)?;
            let end = self.run_stretch(&course, &stretch, balance, &user_stop, &mut watch)?;
            course.add(&stretch, &end, self.turned_ml() - course.before_ml);
            if let Some(Stop::Fault(fault)) = end.stop {
                return Err(course.fault(fault, end.last_g.unwrap_or(course.shown_g)));
            }
            let settled = if end.stopped_by_user {
                Err(BalanceError::Stopped)
            } else {
                self.wait_for_drops(simulated, &mut watch);
                at_rest(balance, longest, &user_stop, simulated)
            };
            match settled {
                Ok(reading) => course.weigh(&end, reading),
                Err(BalanceError::Stopped) => {
                    course.shown_g = end.last_g.unwrap_or(course.shown_g);
                    return Ok(course.delivered(false, std::mem::take(&mut self.notes)));
                }
                Err(error) => {
                    let last_g = end.last_g.unwrap_or(course.shown_g);
                    return Err(course.fault(WeightFault::Balance(error), last_g));
                }
            }
            let checked = course.aim.check(course.weighed_ml(), course.turned_ml, prepared.z_ml_g);
            checked.map_err(|fault| course.fault(fault.where_motor_moves(!simulated), course.shown_g))?;
        }
        let stands = self.stands().without_carry();
        let last = stands.last.map(|dose| LastDose { by_weight: Some(course.on_record()), ..dose });
        let state = PumpState { unfinished: None, after_stop: course.after_stop, last, ..stands };
        let mut delivered = course.delivered(true, std::mem::take(&mut self.notes));
        self.log_weighed(began, prepared, &delivered);
        self.rest(Why::Weighed, state).map_err(|source| DoseError::NotRecorded {
            delivered_ml: delivered.volume_ml,
            end_angle_deg: pump_model::units::degrees(delivered.end_angle_rad),
            source,
        })?;
        delivered.warnings.append(&mut self.notes);
        Ok(delivered)
    }

    /// Returns the volume by the model of the dose so far, in mL.
    fn turned_ml(&self) -> f64 {
        self.stands().unfinished.map_or(0.0, |dose| dose.booked_ml(self.bench.model()))
    }

    /// Plans a stretch of `volume_ml`, and the announced plan that leads beyond the ceiling.
    fn plan_stretch(
        &mut self,
        course: &Course<'_>,
        volume_ml: f64,
        slowly: bool,
    ) -> Result<Stretch, DoseError> {
        let prepared = course.prepared;
        let cruise = if slowly { Some(prepared.slow) } else { prepared.order.request.cruise };
        let begun = self.stands().unfinished;
        let stands = self.stands();
        // The stretches are planned and booked as one sum: from an unknown angle each alone may be wrong as the first.
        let account = stands.account.filter(|_| course.stretches > 0);
        let state = PumpState { unfinished: None, account, ..stands.without_carry() };
        let request = DoseRequest { cruise, ..prepared.order.request };
        let (bench, file) = (self.bench, self.file());
        let part =
            bench.plan_from(file, Some(state), DoseRequest { volume_ml, whole_ml: None, ..request }, None)?;
        // A speed that follows from the volume must be the same in both plans, since it sets the displacement.
        let rad_s = part.plan.profile().cruise_rad_s();
        let cruise = if cruise == Some(Cruise::Fastest) { Some(Cruise::Speed { rad_s }) } else { cruise };
        let beyond_ml = BEYOND_CEILING * course.aim.step_ml + 0.01 * course.aim.unsure_ml;
        let to_end_ml = prepared.most_ml - course.whole_turned_ml() + beyond_ml;
        let asked_ml = prepared.order.request.volume_ml;
        let rest = DoseRequest {
            cruise,
            volume_ml: asked_ml - course.whole_turned_ml(),
            whole_ml: begun.map(|_| asked_ml),
            ..request
        };
        let announced = bench.plan_from(file, Some(state), rest, Some(to_end_ml))?;
        let notes = std::mem::take(&mut self.notes);
        let part = self.checked(part)?;
        self.notes = notes;
        Ok(Stretch { part, announced })
    }

    /// Makes a stretch with a lookout on the balance.
    fn run_stretch(
        &mut self,
        course: &Course<'_>,
        stretch: &Stretch,
        balance: &mut dyn Balance,
        user_stop: &StopRequest,
        watch: &mut dyn FnMut(u64) -> ControlFlow<()>,
    ) -> Result<StretchEnd, DoseError> {
        let Stretch { part, announced } = stretch;
        let motion = RecordedMotion {
            plan: (&part.plan).into(),
            announced: Some(&announced.plan),
            prepared: Some(announced),
            model: &announced.model,
            correction: announced.correction(),
            purpose: Purpose::Dose,
            carry_out_ml: 0.0,
            given: false,
            retract_ml: None,
            whole: self.whole_of_rest(announced),
            terms: DoseTerms {
                by_weight: true,
                weighing: Some(course.prepared.weighing_terms(course.tare_g)),
                ..course.prepared.whole.terms(self.file())
            },
            settle_s: Some(part.prediction.settle_s),
            seeks: false,
            may_pause: true,
        };
        let mut stopped_by_user = false;
        let mut user = |made| {
            let flow = watch(made);
            stopped_by_user |= flow.is_break();
            flow
        };
        let (mut stop, steps) = (None, part.plan.steps().unsigned_abs());
        if self.bench.is_simulated() {
            let moved = self.perform(&motion, &mut user)?;
            let (notes, stood) = (VecDeque::new(), Instant::now());
            let unread =
                StretchEnd { moved, stop, at_rest_g: None, notes, stood, last_g: None, stopped_by_user };
            return Ok(unread);
        }
        let (moved, at_rest_g, last_g, notes, stood) =
            Readings::while_running(balance, user_stop, |readings| {
                let mut lookout = Lookout::new(course, readings);
                let moved = self.perform(&motion, |made| {
                    if user(made).is_break() {
                        return ControlFlow::Break(());
                    }
                    // The motor has been told to stop, or has made all: the line settles now.
                    if stop.is_some() || made >= steps {
                        return ControlFlow::Continue(());
                    }
                    let made_rad = part.plan.angle_after(made) - part.plan.start().angle_rad();
                    let stop_rad = || {
                        let plan = part.plan.stop(&part.model, made);
                        plan.map_or(0.0, |plan| plan.end_angle_rad() - plan.start().angle_rad())
                    };
                    stop = lookout.look(made_rad, stop_rad);
                    if stop.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                })?;
                let stood = self.device.as_ref().map_or(Instant::now(), |device| device.holds_since);
                let mass_g = |sample: Sample| sample.reading.mass_g;
                let at_rest_g = readings.last_until(stood).map(mass_g);
                Ok::<_, DoseError>((moved, at_rest_g, readings.last().map(mass_g), lookout.notes(), stood))
            })?;
        Ok(StretchEnd { moved, stop, at_rest_g, notes, stood, last_g, stopped_by_user })
    }

    /// Waits until the last drop has fallen, or `watch` breaks.
    fn wait_for_drops(&self, simulated: bool, watch: &mut dyn FnMut(u64) -> ControlFlow<()>) {
        let Some(device) = self.device.as_ref().filter(|_| !simulated) else { return };
        while device.holds_since.elapsed() < FALLEN_AFTER && watch(0).is_continue() {
            sleep(Duration::from_millis(20));
        }
    }
}
