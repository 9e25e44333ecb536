//! One motion that is on record before it begins, while it lasts, and after it.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use pump_ctl::plan::{Plan, PlannedMotion};
use pump_model::Pump;

use super::announced_steps::{AnnouncedSteps, DiskTimes, Halt};
use super::connection::lost_by;
use super::device::Device;
use crate::displacement::Correction;
use crate::dosing::{DoseError, Prepared};
use crate::drives::{BeginPlace, BeginView, DriveError, DriveFault, IndexSearch, Leave};
use crate::notice::with_sources;
use crate::pump_file::Pace;
use crate::record::Purpose;
use crate::record::{Announcer, DoseTerms, Entry, Intent, PumpState, Stamp, Unfinished, Whole, Why};

use super::ended_motion::EndedMotion;
use super::real_time::RealTime;
use super::session::{BeforeMotion, Session};
use super::stretches::AnnouncedStretches;

/// Number of steps between two calls of `watch`, at most.
const WATCH_EVERY: u64 = 256;

/// Longest time between two calls of `watch` while steps are made.
const WATCH_WITHIN: Duration = Duration::from_millis(20);

/// Motion to make and to record.
pub(super) struct RecordedMotion<'p> {
    pub(super) plan: PlannedMotion<'p>,
    /// Plan that the journal announces, of which `plan` makes the first steps. `None` if it is `plan` itself.
    pub(super) announced: Option<&'p Plan>,
    /// Dose that the motion makes, or makes a stretch of. `None` for a retraction and a turn to a mark.
    pub(super) prepared: Option<&'p Prepared>,
    /// Pump that the plan was made for.
    pub(super) model: &'p Pump,
    /// Correction of that pump's displacement.
    pub(super) correction: Correction,
    pub(super) purpose: Purpose,
    /// Carry after the motion, in mL.
    pub(super) carry_out_ml: f64,
    /// True if the start angle was given and overrides the record.
    pub(super) given: bool,
    /// Volume to suck back afterwards, in mL.
    pub(super) retract_ml: Option<f64>,
    /// Whole dose of which the motion makes the rest.
    pub(super) whole: Option<Whole>,
    /// Terms of the dose besides its volume.
    pub(super) terms: DoseTerms,
    /// Settling time of the line after the whole plan, in s. `None` if nobody waits for the line.
    pub(super) settle_s: Option<f64>,
    /// True if the motion ends at the index mark.
    pub(super) seeks: bool,
    /// True if the motor may pause until the disk has the next stretch.
    pub(super) may_pause: bool,
}

/// Motion that was made.
pub(super) struct Moved {
    /// Steps made.
    pub(super) made: u64,
    /// Time at which the motion began.
    pub(super) began: Stamp,
    /// Steps made after the index mark.
    pub(super) beyond: Option<u64>,
    /// Volume that the vessel received, in mL. If nobody can read it, the model volume of the steps made.
    pub(super) volume_ml: f64,
    /// Time that the motion took, in s.
    pub(super) measured_s: f64,
    pub(super) disk_times: DiskTimes,
}

/// End of a motion by the drive, with the times and the error of the journal meanwhile.
struct Driven {
    ended: Result<IndexSearch, DriveFault>,
    /// True if the drive was not asked to move.
    is_refused: bool,
    measured_s: f64,
    disk_times: DiskTimes,
    halt: Option<Halt>,
}

impl Driven {
    /// Returns the end of a motion that was refused before the drive was asked to move.
    fn refused(error: DriveError) -> Self {
        let (ended, disk_times) = (Err(DriveFault::at(0, error)), DiskTimes::default());
        Self { ended, is_refused: true, measured_s: 0.0, disk_times, halt: None }
    }

    /// Returns the end of a motion that was refused, if it was called off before it had made a step.
    fn unless(self, is_called_off: bool) -> Self {
        match &self.ended {
            Ok(IndexSearch { made: 0, .. }) if is_called_off && self.halt.is_none() => {
                Self::refused(DriveError::Interrupted)
            }
            _ => self,
        }
    }
}

impl<'a> Session<'a> {
    /// Makes a motion. The intent is on record before the motion, each stretch before its steps, the rest
    /// after the motion.
    pub(super) fn perform(
        &mut self,
        motion: &RecordedMotion<'_>,
        mut watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Moved, DoseError> {
        // An error on the way gives the place up, and the others hear of it.
        let place = self.place.take();
        let begin = place.as_ref().map(BeginPlace::view);
        self.check_confirmed()?;
        self.check_stand()?;
        self.connect()?;
        self.check(motion.plan)?;
        let allowed = self.allow(motion);
        if let (Err(_), Some(device)) = (&allowed, &mut self.device) {
            device.drive.forget_plan();
        }
        let (before, intent) = allowed?;
        let Some(mut device) = self.device.take() else { unreachable!("it was connected above") };
        let keeps_time = self.bench.is_simulated()
            && (motion.terms.until_stopped || self.bench.drive().pace == Some(Pace::Real));
        let real_time = RealTime::of(motion.plan, keeps_time);
        let told = self.before_motion.take().map_or(ControlFlow::Continue(()), BeforeMotion::tell);
        let driven = self.journal.announcing(|announcer| {
            let begins = match told {
                ControlFlow::Continue(()) => place.map_or(Ok(()), |place| device.drive.begin_with(place)),
                ControlFlow::Break(()) => Err(DriveError::Interrupted),
            };
            match begins {
                Ok(()) => drive(&mut device, motion, real_time, announcer, &mut watch),
                Err(error) => {
                    device.drive.forget_plan();
                    Driven::refused(error)
                }
            }
        });
        // Once others begin, a motion that has made no step is an unfinished part of what they make together.
        let others_begin = begin.as_ref().is_some_and(BeginView::is_fixed);
        let Driven { ended, is_refused, measured_s, disk_times, halt } = match driven {
            Ok(driven) => driven.unless(!others_begin && self.is_called_off(motion)),
            // Nothing has moved.
            Err(error) => {
                device.drive.forget_plan();
                self.device = Some(device);
                self.rest(Why::Fault, before)?;
                return Err(error.into());
            }
        };
        self.moved |= !is_refused;
        device.holds_since = Instant::now();
        match ended {
            Ok(IndexSearch { made, beyond }) => {
                let after =
                    EndedMotion { made, beyond, measured_s, disk_times, halt, others_begin, before, intent };
                self.conclude(device, motion, after, &mut || watch(made))
            }
            // Nothing has moved.
            Err(fault) if is_refused || begin.is_some() && !others_begin && fault.is_at_rest() => {
                self.put_away(device.drive);
                self.rest(Why::Fault, before)?;
                Err(DoseError::Connection(fault.error))
            }
            // The device is met anew before it moves again.
            Err(fault) => Err(self.record_fault(device, &before, intent, fault, disk_times.pauses)),
        }
    }

    /// Returns true if another pump has failed, so that a motion that has not begun leaves nothing unfinished. What a
    /// dose is to suck back stays unfinished.
    fn is_called_off(&self, motion: &RecordedMotion<'_>) -> bool {
        motion.purpose != Purpose::Retract && self.bench.opening().stop.is_by_others()
    }

    /// Keeps to the safety limits, and puts on record what came before a motion, and its intent. Returns it with the
    /// state before.
    fn allow(&mut self, motion: &RecordedMotion<'_>) -> Result<(PumpState, Intent), DoseError> {
        // A retraction leaves the vessel, and the stretches of a dose by weight were allowed as a whole.
        if motion.purpose != Purpose::Retract && !motion.terms.by_weight {
            self.keep_safe(motion.plan.planned_ml(motion.model))?;
        }
        self.record_meeting()?;
        self.record_confirmation()?;
        let mut before = self.stands();
        if motion.given {
            before.disturbances = 0;
        }
        let intent = self.announce(motion, &before)?;
        Ok((before, intent))
    }

    /// Writes the intent of a motion.
    fn announce(&mut self, motion: &RecordedMotion<'_>, before: &PumpState) -> Result<Intent, DoseError> {
        let RecordedMotion { plan, correction, purpose, carry_out_ml, .. } = *motion;
        let now = self.log.clock.now();
        let mut intent = match (motion.announced, plan) {
            (Some(announced), PlannedMotion::Dose(_)) | (None, PlannedMotion::Dose(announced)) => {
                Intent::of(announced, correction, purpose, carry_out_ml, now.unix_s)
            }
            (_, PlannedMotion::Flow(flow)) => {
                let planned_ml = plan.planned_ml(motion.model);
                Intent::of_flow(flow, planned_ml, correction, carry_out_ml, now.unix_s)
            }
        };
        intent.told = self.told(motion, now);
        intent.revolution_ml = Some(self.bench.model().revolution_ml());
        intent.inverted = self.bench.drive().invert;
        intent.motor_way = (!self.bench.is_simulated()).then(|| self.bench.motor_way());
        intent.retract_ml = motion.retract_ml;
        intent.terms = motion.terms;
        intent.whole = motion.whole;
        intent.carry_in_half_width_ml = before.carry_within_ml(self.bench.model());
        if !motion.given && before.half_width_rad > intent.half_width_rad {
            // A disturbance since the motion was planned counts.
            intent.widen(before.half_width_rad, self.bench.model());
        }
        self.journal.append(&Entry::Intent(intent))?;
        Ok(intent)
    }

    /// Records the state after a fault of a motion that paused so many times.
    fn record_fault(
        &mut self,
        mut device: Device<'a>,
        before: &PumpState,
        intent: Intent,
        fault: DriveFault,
        pauses: u8,
    ) -> DoseError {
        let DriveFault { made_least, made_most, lost, count_lost, error } = fault;
        let model = self.bench.model();
        let ended_s = self.log.clock.now().unix_s;
        let after = before.after_until(ended_s, &intent, made_least, made_most, model);
        let after = if lost { after.lost(lost_by(&error), model) } else { after };
        let mut state = self.with_device(&mut device, after, Some(pauses));
        state.released = device.drive.is_without_current();
        // A turn to find the angle is no part of the unfinished dose that stays on record.
        let is_delivery = intent.purpose.is_delivery();
        let may_tell = state.count.is_none() && !lost && !count_lost && is_delivery;
        if let Some(part) = state.unfinished.as_mut().filter(|_| may_tell) {
            part.count_before = before.count;
        }
        // A motor that was stopped without a ramp may have slipped beside its count.
        let told = state.unfinished.filter(|part| part.intent == intent);
        let told = told.unwrap_or(Unfinished::of(&intent, made_least, made_most));
        self.log_fault(&intent, told.made_least, told.made_most, with_sources(&error));
        // If this fails, the journal's last stretch tells as much with wider bounds.
        if self.rest(Why::Fault, state).is_ok() {
            device.drive.recorded();
        }
        self.put_away(device.drive);
        let (least_ml, most_ml) = told.delivered_ml(model);
        let (unfinished, over_time) = (state.unfinished.is_some(), intent.terms.profile);
        DoseError::Drive { error, least_ml, most_ml, unfinished, over_time }
    }
}

/// Turns the motor. The motor stops where `watch` breaks, or where the next stretch cannot be recorded.
fn drive(
    device: &mut Device<'_>,
    motion: &RecordedMotion<'_>,
    mut real_time: RealTime<'_>,
    announcer: &Announcer,
    watch: &mut dyn FnMut(u64) -> ControlFlow<()>,
) -> Driven {
    let drive = device.drive.as_mut();
    let stretches = AnnouncedStretches::new(motion.plan, motion.model, !drive.is_simulated());
    let mut announced = AnnouncedSteps::new(stretches, announcer, motion.may_pause);
    let mut looked = Instant::now();
    let mut gate = |made: u64, about_to: u64| {
        if real_time.wait(made, watch).is_break() {
            return Leave::Stop;
        }
        // Drives that make many steps at a time ask seldom enough to call `watch` every time.
        let looks = about_to > announced.end
            || about_to > made + 1
            || made.is_multiple_of(WATCH_EVERY)
            || looked.elapsed() >= WATCH_WITHIN;
        if looks {
            looked = Instant::now();
        }
        if looks && watch(made).is_break() { Leave::Stop } else { announced.leave(made, about_to) }
    };
    drive.displaces(motion.correction);
    let made_all = |made| IndexSearch { made, beyond: None };
    let ended = match motion.plan {
        PlannedMotion::Dose(plan) if motion.seeks => drive.seek(plan, &mut gate),
        PlannedMotion::Dose(plan) => drive.run(plan, &mut gate).map(made_all),
        PlannedMotion::Flow(flow) => drive.run_flow(flow, &mut gate).map(made_all),
    };
    let AnnouncedSteps { disk_times, halt, .. } = announced;
    let time_of = |made| motion.plan.time_of(made);
    let measured_s = real_time.took_s().or(drive.simulated_s()).unwrap_or_else(|| disk_times.took_s(time_of));
    Driven { ended, is_refused: false, measured_s, disk_times, halt }
}
