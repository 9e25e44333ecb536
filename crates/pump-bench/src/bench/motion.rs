//! One motion: on record before it begins, while it lasts, and after it.

use std::ops::ControlFlow;
use std::time::Instant;

use pump_ctl::plan::Plan;
use pump_model::Pump;
use pump_model::math::degrees;

use crate::displacement::Correction;
use crate::dosing::DoseError;
use crate::drives::{Disturbance, Drive, Sought};
use crate::record::Purpose;
use crate::record::{Entry, Intent, JournalError, State, Terms, Unfinished, Why};

use super::session::{Session, unix_s};
use super::stretches::Stretches;

/// Steps between two looks at whether to stop.
const WATCH_EVERY: u64 = 256;

/// What is to be done.
pub(super) struct Motion<'p> {
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

impl Session<'_> {
    pub(super) fn perform(
        &mut self,
        motion: &Motion<'_>,
        mut watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Moved, DoseError> {
        self.connect()?;
        if let (false, Some(state)) = (self.written, self.state) {
            self.rest(Why::CutOff, state)?;
        }
        let (plan, model) = (motion.plan, self.bench.model());
        self.check(plan)?;
        let mut before = self.stands();
        if motion.given {
            before.disturbances = 0;
        }
        let mut intent = Intent::of(plan, motion.correction, motion.purpose, motion.carry_out_ml, unix_s());
        intent.retract_ml = motion.retract_ml;
        intent.terms = motion.terms;
        if !motion.given {
            // A disturbance since it was planned counts.
            intent.half_width_rad = intent.half_width_rad.max(before.half_width_rad);
        }
        self.journal.append(&Entry::Intent(intent))?;

        let mut stretches = Stretches::new(plan, motion.model);
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

        let Some(device) = &mut self.device else { unreachable!("it was connected above") };
        let drive = device.drive.as_mut();
        drive.displaces(motion.correction);
        let moved = if motion.seeks {
            drive.seek(plan, &mut gate)
        } else {
            drive.run(plan, &mut gate).map(|made| Sought { made, beyond: None })
        };
        device.holds_since = Instant::now();
        let (fall_rad, pitch_rad) = (self.bench.fall_rad(), model.pitch_rad());
        let notes = &mut device.notes;
        let mut met = |drive: &mut dyn Drive, state: State| {
            // Asked first: it may hear of a reset that changes the count.
            let event = drive.disturbed();
            let state = State { count: drive.count(), ..state };
            let Some(event) = event else { return state };
            if event != Disturbance::Disabled {
                notes.push(format!("{event}: where the rollers stand is known less well"));
            }
            state.disturbed(fall_rad, pitch_rad)
        };
        let Sought { made, beyond } = match moved {
            Ok(moved) => moved,
            Err(fault) => {
                let after = before.after(&intent, fault.made_least, fault.made_most, model);
                let mut state = met(drive, if fault.lost { after.lost(pitch_rad) } else { after });
                if let (None, false, Some(part)) = (state.count, fault.lost, &mut state.unfinished) {
                    part.count_before = before.count;
                }
                // What turned the motor is met anew before it moves again.
                self.device = None;
                // The journal's last stretch says as much, with wider bounds.
                let _ = self.rest(Why::Fault, state);
                let (made_least, made_most) = (fault.made_least, fault.made_most);
                let (least_ml, most_ml) =
                    Unfinished { intent, made_least, made_most, count_before: None }.delivered_ml(model);
                let unfinished = state.unfinished.is_some();
                return Err(DoseError::Drive { error: fault.error, least_ml, most_ml, unfinished });
            }
        };
        let read_ml = drive.settle(motion.settle_s);
        let counted_ml = plan.delivered_ml(motion.model, made);
        let state = met(drive, before.after(&intent, made, made, model));
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
