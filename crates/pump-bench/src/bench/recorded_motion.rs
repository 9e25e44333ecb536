//! One motion that is on record before it begins, while it lasts, and after it.

use std::ops::ControlFlow;
use std::time::Instant;

use pump_ctl::plan::Plan;
use pump_model::Pump;
use pump_model::math::degrees;

use super::device::Device;
use crate::displacement::Correction;
use crate::dosing::DoseError;
use crate::drives::{Disturbance, DriveFault, Sought};
use crate::record::Purpose;
use crate::record::{Entry, Intent, JournalError, State, Terms, Unfinished, Why};

use super::session::{Session, unix_s};
use super::stretches::Stretches;

/// Number of steps between two calls of `watch`.
const WATCH_EVERY: u64 = 256;

/// Motion to make and to record.
pub(super) struct RecordedMotion<'p> {
    pub(super) plan: &'p Plan,
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
    /// Terms of the dose besides its volume.
    pub(super) terms: Terms,
    /// Settling time of the line, in s.
    pub(super) settle_s: f64,
    /// True if the motion ends at the index mark.
    pub(super) seeks: bool,
}

/// Motion that was made.
pub(super) struct Moved {
    /// Steps made.
    pub(super) made: u64,
    /// Steps made after the index mark.
    pub(super) beyond: Option<u64>,
    /// Volume that the vessel received, in mL. If nobody can read it, the model volume of the steps made.
    pub(super) volume_ml: f64,
}

/// End of a motion by the drive, and the journal's error meanwhile.
struct Driven {
    ended: Result<Sought, DriveFault>,
    unwritten: Option<JournalError>,
}

impl<'a> Session<'a> {
    /// Makes a motion. The intent is on record before the motion, each stretch before its steps, the rest
    /// after the motion.
    pub(super) fn perform(
        &mut self,
        motion: &RecordedMotion<'_>,
        watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Moved, DoseError> {
        self.connect()?;
        if let (false, Some(state)) = (self.written, self.state) {
            self.rest(Why::CutOff, state)?;
        }
        self.check(motion.plan)?;
        let mut before = self.stands();
        if motion.given {
            before.disturbances = 0;
        }
        let intent = self.announce(motion, &before)?;
        let Some(mut device) = self.device.take() else { unreachable!("it was connected above") };
        self.moved = true;
        let Driven { ended, unwritten } = self.drive(&mut device, motion, watch);
        device.holds_since = Instant::now();
        match ended {
            Ok(sought) => self.conclude(device, motion, &before, &intent, sought, unwritten),
            // The device is dropped, so it is met anew before it moves again.
            Err(fault) => Err(self.record_fault(device, &before, intent, fault)),
        }
    }

    /// Writes the intent of a motion.
    fn announce(&mut self, motion: &RecordedMotion<'_>, before: &State) -> Result<Intent, DoseError> {
        let RecordedMotion { plan, correction, purpose, carry_out_ml, .. } = *motion;
        let mut intent = Intent::of(plan, correction, purpose, carry_out_ml, unix_s());
        intent.retract_ml = motion.retract_ml;
        intent.terms = motion.terms;
        if !motion.given {
            // A disturbance since the motion was planned counts.
            intent.half_width_rad = intent.half_width_rad.max(before.half_width_rad);
        }
        self.journal.append(&Entry::Intent(intent))?;
        Ok(intent)
    }

    /// Turns the motor. The motor stops where `watch` breaks, or where the next stretch cannot be recorded.
    fn drive(
        &mut self,
        device: &mut Device<'_>,
        motion: &RecordedMotion<'_>,
        mut watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Driven {
        let mut stretches = Stretches::new(motion.plan, motion.model);
        let mut unwritten: Option<JournalError> = None;
        let journal = &mut self.journal;
        let mut gate = |made: u64, about_to: u64| {
            let ends = about_to > stretches.end;
            // Drives that make many steps at a time ask seldom enough to call `watch` every time.
            let looks = ends || about_to > made + 1 || made.is_multiple_of(WATCH_EVERY);
            if looks && watch(made).is_break() {
                return ControlFlow::Break(());
            }
            if ends {
                let may = stretches.next(about_to);
                if let Err(error) = journal.append(&Entry::Progress { made, may }) {
                    unwritten = Some(error);
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        };
        let drive = device.drive.as_mut();
        drive.displaces(motion.correction);
        let ended = if motion.seeks {
            drive.seek(motion.plan, &mut gate)
        } else {
            drive.run(motion.plan, &mut gate).map(|made| Sought { made, beyond: None })
        };
        Driven { ended, unwritten }
    }

    /// Returns the state with the device's count and disturbances.
    fn with_device(&self, device: &mut Device<'_>, state: State) -> State {
        // The drive reports disturbances first: it may hear of a reset that changes the count.
        let event = device.drive.disturbed();
        let state = State { count: device.drive.count(), ..state };
        let Some(event) = event else { return state };
        if event != Disturbance::Disabled {
            device.notes.push(format!("{event}: the rollers' angle is known less well"));
        }
        state.disturbed(self.bench.fall_rad(), self.bench.model().pitch_rad())
    }

    /// Records the state after a fault.
    fn record_fault(
        &mut self,
        mut device: Device<'_>,
        before: &State,
        intent: Intent,
        fault: DriveFault,
    ) -> DoseError {
        let DriveFault { made_least, made_most, lost, error } = fault;
        let model = self.bench.model();
        let after = before.after(&intent, made_least, made_most, model);
        let after = if lost { after.lost(model.pitch_rad()) } else { after };
        let mut state = self.with_device(&mut device, after);
        if let (None, false, Some(part)) = (state.count, lost, &mut state.unfinished) {
            part.count_before = before.count;
        }
        // If this fails, the journal's last stretch tells as much with wider bounds.
        let _ = self.rest(Why::Fault, state);
        let (least_ml, most_ml) =
            Unfinished { intent, made_least, made_most, count_before: None }.delivered_ml(model);
        DoseError::Drive { error, least_ml, most_ml, unfinished: state.unfinished.is_some() }
    }

    /// Lets the line settle and records the state after the motion.
    fn conclude(
        &mut self,
        mut device: Device<'a>,
        motion: &RecordedMotion<'_>,
        before: &State,
        intent: &Intent,
        sought: Sought,
        unwritten: Option<JournalError>,
    ) -> Result<Moved, DoseError> {
        let Sought { made, beyond } = sought;
        let plan = motion.plan;
        let read_ml = device.drive.settle(motion.settle_s);
        let counted_ml = plan.delivered_ml(motion.model, made);
        let after = before.after(intent, made, made, self.bench.model());
        let state = self.with_device(&mut device, after);
        self.device = Some(device);
        let why = match &unwritten {
            Some(_) => Why::Fault,
            None if made == plan.steps.unsigned_abs() || beyond.is_some() => Why::Done,
            None => Why::Stopped,
        };
        let rested = self.rest(why, state);
        let volume_ml = match read_ml {
            Ok(read_ml) => read_ml.unwrap_or(counted_ml),
            Err(error) => {
                let unfinished = state.unfinished.is_some();
                return Err(DoseError::Drive {
                    error,
                    least_ml: counted_ml,
                    most_ml: counted_ml,
                    unfinished,
                });
            }
        };
        if let Some(source) = unwritten {
            return Err(DoseError::NotJournalled { delivered_ml: volume_ml, source });
        }
        rested.map_err(|source| DoseError::NotRecorded {
            delivered_ml: volume_ml,
            end_angle_deg: degrees(plan.angle_after(made)),
            source,
        })?;
        Ok(Moved { made, beyond, volume_ml })
    }
}
