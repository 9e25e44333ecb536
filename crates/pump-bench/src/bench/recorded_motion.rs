//! One motion: on record before it begins, while it lasts, and after it.

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

/// Steps between two looks at whether to stop.
const WATCH_EVERY: u64 = 256;

/// What is to be done.
pub(super) struct RecordedMotion<'p> {
    pub(super) plan: &'p Plan,
    /// The pump that it was planned for.
    pub(super) model: &'p Pump,
    /// The calibration in that pump.
    pub(super) correction: Correction,
    pub(super) purpose: Purpose,
    /// What the next dose owes afterwards, mL.
    pub(super) carry_out_ml: f64,
    /// Whether the start angle was given and overrides the record.
    pub(super) given: bool,
    /// What is to be sucked back afterwards, mL.
    pub(super) retract_ml: Option<f64>,
    /// What else was asked.
    pub(super) terms: Terms,
    /// How long the line needs to settle, s.
    pub(super) settle_s: f64,
    /// Whether it ends at the index mark.
    pub(super) seeks: bool,
}

/// What was done.
pub(super) struct Moved {
    /// Steps made.
    pub(super) made: u64,
    /// How many of them after the index mark.
    pub(super) beyond: Option<u64>,
    /// What the vessel received, mL; where nobody can read it, the model volume of the steps made.
    pub(super) volume_ml: f64,
}

/// How a drive ended a motion, and what could not be written down meanwhile.
struct Driven {
    ended: Result<Sought, DriveFault>,
    unwritten: Option<JournalError>,
}

impl<'a> Session<'a> {
    /// Makes a motion: the intent is on record before it, each stretch before its steps, the rest after it.
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
        self.has_moved = true;
        let Driven { ended, unwritten } = self.drive(&mut device, motion, watch);
        device.holds_since = Instant::now();
        match ended {
            Ok(sought) => self.conclude(device, motion, &before, &intent, sought, unwritten),
            // The device is dropped: what turned the motor is met anew before it moves again.
            Err(fault) => Err(self.record_fault(device, &before, intent, fault)),
        }
    }

    /// Writes the intent: how things may stand from now on.
    fn announce(&mut self, motion: &RecordedMotion<'_>, before: &State) -> Result<Intent, DoseError> {
        let RecordedMotion { plan, correction, purpose, carry_out_ml, .. } = *motion;
        let mut intent = Intent::of(plan, correction, purpose, carry_out_ml, unix_s());
        intent.retract_ml = motion.retract_ml;
        intent.terms = motion.terms;
        if !motion.given {
            // A disturbance since it was planned counts.
            intent.half_width_rad = intent.half_width_rad.max(before.half_width_rad);
        }
        self.journal.append(&Entry::Intent(intent))?;
        Ok(intent)
    }

    /// Turns the motor. It stops where `watch` breaks, or where the next stretch cannot be written down.
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
            // Drives that make many steps at a time ask seldom enough to look every time.
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

    /// The state with what the device has to say of it.
    fn with_device(&self, device: &mut Device<'_>, state: State) -> State {
        // Asked first: it may hear of a reset that changes the count.
        let event = device.drive.disturbed();
        let state = State { count: device.drive.count(), ..state };
        let Some(event) = event else { return state };
        if event != Disturbance::Disabled {
            device.notes.push(format!("{event}: where the rollers stand is known less well"));
        }
        state.disturbed(self.bench.fall_rad(), self.bench.model().pitch_rad())
    }

    /// Records how things stand after a fault.
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
        // The journal's last stretch says as much, with wider bounds.
        let _ = self.rest(Why::Fault, state);
        let (least_ml, most_ml) =
            Unfinished { intent, made_least, made_most, count_before: None }.delivered_ml(model);
        DoseError::Drive { error, least_ml, most_ml, unfinished: state.unfinished.is_some() }
    }

    /// Lets the line settle and records how things stand after the motion.
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
