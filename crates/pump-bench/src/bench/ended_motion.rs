//! The end of a motion: its record, then the wait for the line.

use std::time::Instant;

use pump_model::Pump;
use pump_model::units::degrees;

use super::announced_steps::{DiskTimes, Halt};
use super::connection::after_event;
use super::device::Device;
use super::recorded_motion::{Moved, RecordedMotion};
use super::session::Session;
use crate::dosing::{DoseError, settle_of_s};
use crate::drives::{Disturbance, Watch};
use crate::notice::Notice;
use crate::numbers::significant;
use crate::record::{Intent, PumpState, Stamp, Wear, Why};

/// Remainder of a wait that is too short to be told, in s.
const NEARLY_S: f64 = 0.1;

/// Most rests of a motion that are counted. The record says after two that the angle is unknown.
const MOST_RESTS: u32 = 255;

/// Motion that the drive has ended.
pub(super) struct EndedMotion {
    /// Steps made.
    pub(super) made: u64,
    /// Steps made after the index mark.
    pub(super) beyond: Option<u64>,
    /// Time that the motion took, in s.
    pub(super) measured_s: f64,
    pub(super) disk_times: DiskTimes,
    /// Reason of the journal to end the motion.
    pub(super) halt: Option<Halt>,
    /// True if motions that were to begin with this one begin.
    pub(super) others_begin: bool,
    /// State before the motion.
    pub(super) before: PumpState,
    pub(super) intent: Intent,
}

impl<'a> Session<'a> {
    /// Records the state after a motion, then lets the line settle. `watch` ends the wait.
    pub(super) fn conclude(
        &mut self,
        mut device: Device<'a>,
        motion: &RecordedMotion<'_>,
        ended: EndedMotion,
        watch: &mut Watch<'_>,
    ) -> Result<Moved, DoseError> {
        let EndedMotion { made, beyond, measured_s, disk_times, halt, others_begin, before, intent } = ended;
        let plan = motion.plan;
        let whole = made == plan.steps().unsigned_abs();
        // A run until it is stopped is complete once somebody stopped it.
        let is_complete = halt.is_none() && motion.terms.until_stopped;
        // A flow over time cannot go on later, so a stop is its end.
        let is_unbegun = !others_begin && self.is_unbegun(motion, made);
        let is_ended = is_complete || (halt.is_none() && (motion.terms.profile || is_unbegun));
        let after =
            after_steps(before, self.log.clock.now().unix_s, &intent, made, is_ended, self.bench.model());
        // The plan of a flow over time tells no time for a part of its steps.
        let wear = Wear { motion_s: before.wear.motion_s + measured_s, ..after.wear };
        let after = PumpState { wear, ..after };
        let state = self.with_device(&mut device, after, Some(disk_times.pauses));
        let why = match &halt {
            Some(_) => Why::Fault,
            None if whole || is_complete || beyond.is_some() => Why::Done,
            None => Why::Stopped,
        };
        self.log_end(motion, &intent, made, measured_s, halt.as_ref(), beyond.is_some());
        let mut rested = self.rest(why, state);
        let settle_s = self.settles_within_s(motion, made);
        let began = Instant::now();
        let read_ml = device.drive.settle(settle_s, watch);
        let left_s = settle_s - began.elapsed().as_secs_f64();
        if whole && !device.drive.is_simulated() && left_s > NEARLY_S {
            self.notes.push(format!(
                "stopped by the user {} s before the line has settled: the last of the volume still flows",
                significant(left_s, 2)
            ).into());
        }
        // The device may have been reset while the line settled.
        let settled = self.with_device(&mut device, state, None);
        if settled != state {
            rested = rested.and(self.rest(Why::Met, settled));
        }
        if self.written {
            device.drive.recorded();
        }
        self.device = Some(device);
        let counted_ml = plan.delivered_ml(motion.model, made);
        let volume_ml = match read_ml {
            Ok(read_ml) => read_ml.unwrap_or(counted_ml),
            Err(error) => {
                let unfinished = state.unfinished.is_some();
                return Err(DoseError::Drive {
                    error,
                    least_ml: counted_ml,
                    most_ml: counted_ml,
                    unfinished,
                    over_time: intent.terms.profile,
                });
            }
        };
        if let Some(halt) = halt {
            return Err(self.of_journal(halt, volume_ml, &disk_times, motion));
        }
        rested.map_err(|source| DoseError::NotRecorded {
            delivered_ml: volume_ml,
            end_angle_deg: degrees(plan.angle_after(made)),
            source,
        })?;
        let began = Stamp::new(intent.unix_s, intent.told.map_or(0, |told| told.utc_offset_s));
        Ok(Moved { made, began, beyond, volume_ml, measured_s, disk_times })
    }

    /// Returns true for a dose that was stopped before its first step, which leaves nothing to resume.
    ///
    /// A share of a rack keeps its rest, since its partners may have moved. So does the rest of a dose that was begun
    /// before. A turn to find the angle leaves the dose that is unfinished.
    fn is_unbegun(&self, motion: &RecordedMotion<'_>, made: u64) -> bool {
        let is_first = motion.purpose.is_delivery() && motion.whole.is_none() && !motion.terms.by_weight;
        made == 0 && is_first && self.log.rack.is_none()
    }

    /// Returns the error of a motion that the journal has ended after `delivered_ml`.
    fn of_journal(
        &self,
        halt: Halt,
        delivered_ml: f64,
        disk_times: &DiskTimes,
        motion: &RecordedMotion<'_>,
    ) -> DoseError {
        match halt {
            Halt::Unwritten(source) => DoseError::NotJournalled { delivered_ml, source },
            Halt::Late => DoseError::SlowDisk {
                delivered_ml,
                took_s: disk_times.slowest.as_secs_f64(),
                journal: self.journal.path().to_owned(),
                must_not_pause: !motion.may_pause,
            },
        }
    }

    /// Returns the time that the line takes to settle after the first `made` steps of a motion, in s, and 0 where
    /// nobody waits for it. A stop is steeper than the end of the plan, so its line settles later.
    fn settles_within_s(&mut self, motion: &RecordedMotion<'_>, made: u64) -> f64 {
        let Some(whole_s) = motion.settle_s else { return 0.0 };
        let settle_s = settle_of_s(motion.plan, motion.model, whole_s, made);
        if settle_s.is_finite() {
            return settle_s;
        }
        self.notes.push(Notice::from(
            "the line does not come to rest within an hour, so nobody waits for it: the last of the volume still flows",
        ));
        0.0
    }

    /// Returns the state with the device's count and disturbances. `pauses` is how often a motion just made has
    /// paused, and `None` at rest.
    ///
    /// A motor that is let go after each motion is let go in each pause too, whatever ended the motion and whoever was
    /// late: the disk, or this program.
    pub(super) fn with_device(
        &mut self,
        device: &mut Device<'_>,
        state: PumpState,
        pauses: Option<u8>,
    ) -> PumpState {
        // The drive reports disturbances first: it may hear of a reset that changes the count.
        let lets_go = !device.drive.holds_at_rest();
        let let_go = (lets_go && pauses.is_some()).then_some(Disturbance::Disabled);
        let event = device.drive.disturbed().or(let_go);
        self.notes.append(&mut device.drive.notes());
        let state = PumpState { count: device.drive.count(), ..state };
        let Some(event) = event else { return state };
        if let Disturbance::Halted { slip_steps, without_current } = event {
            let (halted, note) = self.after_halt(state, slip_steps, without_current);
            self.notes.push(note);
            return halted;
        }
        let (fall_rad, model) = (self.bench.fall_rad(), self.bench.model());
        let is_let_go = event == Disturbance::Disabled;
        if !is_let_go {
            let now = match event {
                Disturbance::EmergencyStop => "the rollers' angle is unknown",
                _ => "the rollers' angle is known less well",
            };
            self.notes.push(format!("{event}: {now}").into());
        }
        let rests = pauses.filter(|_| is_let_go || lets_go);
        let rests = rests.map_or(0, |pauses| u32::from(pauses).max(device.drive.rests()).min(MOST_RESTS));
        (0..=rests).fold(state, |state, _| after_event(state, event, fall_rad, model))
    }
}

/// Returns the state after the first `made` steps of `intent`. A motion that `is_ended` leaves nothing unfinished.
fn after_steps(
    before: PumpState,
    ended_s: u64,
    intent: &Intent,
    made: u64,
    is_ended: bool,
    model: &Pump,
) -> PumpState {
    let after = before.after_until(ended_s, intent, made as i64, made as i64, model);
    PumpState { unfinished: after.unfinished.filter(|_| !is_ended), ..after }
}
