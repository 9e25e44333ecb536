//! The entries that a session gives to the log.

use pump_ctl::plan::PlannedMotion;

use crate::bench::announced_steps::Halt;
use crate::bench::recorded_motion::RecordedMotion;
use crate::bench::session::Session;
use crate::bench::{DeliveredByWeight, PreparedByWeight};
use crate::dosing::{Prepared, RunBound, Swept, weighed_shares};
use crate::notice::with_sources;
use crate::record::{
    Clock, DosedFluid, Intent, LogEnd, LogEntry, PumpState, Purpose, ShortText, Stamp, Told, Unfinished, Why,
};

/// Variable of the environment by which a service names its order, which the log keeps.
const ORDER: &str = "DOSE_ORDER";

/// Returns the order that the environment names.
fn order_of_environment() -> Option<ShortText> {
    std::env::var(ORDER).ok().filter(|order| !order.is_empty()).map(|order| ShortText::new(&order))
}

impl Session<'_> {
    /// Has doses get their times from `clock`, in place of the system's.
    pub fn keep_time_by(&mut self, clock: Box<dyn Clock>) {
        self.log.clock = clock;
    }

    /// Has the log name the rack of which this pump's motions are a part.
    pub(crate) fn name_rack(&mut self, rack: &str) {
        self.log.rack = Some(ShortText::new(rack));
    }

    /// Returns the part of an intent that only the log needs. `None` for a turn to find the angle, unless it is a
    /// search for the index within an unfinished dose, whose volume goes where that dose goes.
    pub(in crate::bench) fn told(&self, motion: &RecordedMotion<'_>, now: Stamp) -> Option<Told> {
        let prepared = motion.prepared;
        (motion.purpose != Purpose::Jog || self.searches_unfinished(motion)).then(|| Told {
            number: self.log.doses + 1,
            utc_offset_s: now.utc_offset_s,
            asked: prepared.and_then(|prepared| prepared.request.asked),
            expanded_uncertainty_ml: self.uncertainty_ml(motion, motion.plan.steps().unsigned_abs()),
            calibration: prepared
                .and_then(|prepared| Some(prepared.applied.as_ref()?.calibration.as_ref()?.version)),
            earlier_ml: if motion.terms.by_weight { self.earlier_ml() } else { 0.0 },
            rack: self.log.rack,
            order: order_of_environment(),
            fluid: Some(self.fluid_of(motion)),
        })
    }

    /// Returns true for a search for the index while a dose is unfinished. A dose by weight whose entry is still to be
    /// written has the next number of the log.
    fn searches_unfinished(&self, motion: &RecordedMotion<'_>) -> bool {
        motion.seeks && self.stands().unfinished.is_some() && self.log.unlogged.is_none()
    }

    /// Returns the fluid of a motion. The rest of a dose and its retraction have that of the dose.
    fn fluid_of(&self, motion: &RecordedMotion<'_>) -> DosedFluid {
        let stands = self.stands();
        let recorded = match motion.purpose {
            Purpose::Retract => stands.last.and_then(|dose| dose.fluid),
            _ if motion.whole.is_some() => stands.unfinished.and_then(|dose| dose.intent.told?.fluid),
            _ => None,
        };
        recorded.unwrap_or(DosedFluid::of(&self.bench.file().fluid))
    }

    /// Returns the volume of the unfinished dose by weight, in mL, that the log has from earlier commands.
    fn earlier_ml(&self) -> f64 {
        let Some(dose) = self.stands().unfinished else { return 0.0 };
        match dose.intent.told {
            // An earlier stretch of this command, whose entry is still to come.
            Some(told) if told.number > self.log.doses => told.earlier_ml,
            _ => dose.booked_ml(self.bench.model()),
        }
    }

    /// Keeps the entry of a motion that the drive has ended, for the rest that follows. `made` is the number of steps
    /// and `measured_s` the time that the motion took. `found` is true if it ended at the index.
    pub(in crate::bench) fn log_end(
        &mut self,
        motion: &RecordedMotion<'_>,
        intent: &Intent,
        made: u64,
        measured_s: f64,
        halt: Option<&Halt>,
        found: bool,
    ) {
        let part = Unfinished::of(intent, made as i64, made as i64);
        let end = match halt {
            Some(_) => LogEnd::Fault,
            None if found || made == motion.plan.steps().unsigned_abs() => LogEnd::Done,
            None => LogEnd::Stopped,
        };
        let Some(entry) = self.entry(&part, end) else { return };
        self.log.ended = Some(LogEntry {
            delivered_ml: motion.plan.delivered_ml(motion.model, made),
            // The steps were counted, and the uncertainty has the angle's share.
            delivered_range_ml: None,
            expanded_uncertainty_ml: match end {
                LogEnd::Done if !entry.until_stopped => entry.expanded_uncertainty_ml,
                _ => self.uncertainty_ml(motion, made),
            },
            cause: match halt {
                Some(Halt::Unwritten(source)) => Some(with_sources(source)),
                Some(Halt::Late) => Some("the disk with the journal was too slow".to_owned()),
                None if end == LogEnd::Stopped => self.stopped_by(),
                None => motion.prepared.and_then(|prepared| prepared.ends_at).and_then(RunBound::cause),
            },
            motion_s: Some(measured_s),
            ..entry
        });
    }

    /// Returns who or what asked the motion to stop. `None` if nobody says.
    fn stopped_by(&self) -> Option<String> {
        self.bench.opening().stop.cause()
    }

    /// Keeps the entry of a motion that failed after `least` to `most` steps, for the rest that follows.
    pub(in crate::bench) fn log_fault(&mut self, intent: &Intent, least: i64, most: i64, cause: String) {
        let entry = self.entry(&Unfinished::of(intent, least, most), LogEnd::Fault);
        self.log.ended = entry.map(|entry| LogEntry { cause: Some(cause), ..entry });
    }

    /// Keeps the entry of a dose that a balance has ended, for the rest that follows. The readings are as unsure as
    /// their last digit.
    pub(in crate::bench) fn log_weighed(
        &mut self,
        began: Stamp,
        prepared: &PreparedByWeight,
        delivered: &DeliveredByWeight,
    ) {
        let (file, volume_ml) = (self.bench.file(), delivered.volume_ml);
        let reading_ml = delivered.difference_standard_g(None, file) * prepared.z_ml_g;
        let shares = weighed_shares(file, volume_ml, reading_ml, prepared.whole.drop_ml);
        let sign = if volume_ml < 0.0 { -1 } else { 1 };
        // The parts of earlier commands have entries of their own, with what the model says of them.
        let earlier_ml =
            self.stands().unfinished.and_then(|dose| dose.intent.told).map_or(0.0, |told| told.earlier_ml);
        self.log.ended = self.entry_by_weight(began, LogEnd::Weighed).map(|entry| LogEntry {
            delivered_ml: volume_ml - earlier_ml,
            delivered_range_ml: None,
            expanded_uncertainty_ml: shares.ok().map(|(_, expanded_ml)| expanded_ml),
            steps: Some(delivered.made as i64 * sign),
            motion_s: Some(delivered.measured_s),
            ..entry
        });
    }

    /// Records the end of a dose by weight that was broken off.
    pub(in crate::bench) fn log_broken_off(&mut self, began: Stamp, end: LogEnd, cause: Option<String>) {
        let Some(entry) = self.entry_by_weight(began, end) else { return };
        let cause = cause.or_else(|| self.stopped_by().filter(|_| end == LogEnd::Stopped));
        self.log.ended = Some(LogEntry { cause, steps: None, ..entry });
        let why = if end == LogEnd::Stopped { Why::Stopped } else { Why::Fault };
        // If this fails, the next rest has the entry, or the next session finds that the dose has none.
        let _ = self.rest(why, self.stands());
    }

    /// Returns the entry of a dose by weight, all its stretches, which began at `began`.
    fn entry_by_weight(&self, began: Stamp, end: LogEnd) -> Option<LogEntry> {
        let dose = self.stands().unfinished.filter(|dose| dose.intent.terms.by_weight)?;
        let entry = self.entry_of(&dose, end);
        let earlier_ml = dose.intent.told.map_or(0.0, |told| told.earlier_ml);
        Some(LogEntry { time: began, requested_ml: dose.intent.whole_requested_ml() - earlier_ml, ..entry })
    }

    /// Returns the dose that ends with a rest in `state`: that of this session, or one that an earlier process left
    /// without an entry.
    pub(in crate::bench) fn ended_dose(&mut self, why: Why, state: &PumpState) -> Option<LogEntry> {
        let ended = self.log.ended.take().or_else(|| {
            let left = self.log.unlogged.take()?;
            let found = self.found(&left, why, state);
            let before = self.stands();
            let all = found.intent.steps.abs();
            let is_whole = (found.made_least, found.made_most) == (all, all);
            let mut entry = match is_whole && found.intent.purpose.is_delivery() {
                true => LogEntry {
                    cause: Some("by the board alone, after the process ended".to_owned()),
                    ..self.entry_of(&found, LogEnd::Done)
                },
                false => self.entry_of(&found, LogEnd::CutOff),
            };
            // The first stretch of a dose by weight began it.
            if let Some(last) = before.last.filter(|_| left.intent.terms.by_weight) {
                entry.time.unix_s = last.unix_s;
            }
            Some(entry)
        });
        let ended = ended.or_else(|| self.counted_later(why, state));
        ended.map(|entry| LogEntry { carry_ml: state.carry_ml, ..entry })
    }

    /// Returns the entry of the last dose anew, if its device was out of reach and has told in `state` which steps it
    /// made. It takes the place of the entry with the bounds.
    fn counted_later(&self, why: Why, state: &PumpState) -> Option<LogEntry> {
        let lost = self.stands().unfinished.filter(|part| part.count_before.is_some())?;
        let number = lost.intent.told.map(|told| told.number).filter(|number| *number == self.log.doses)?;
        let made = |part: &Unfinished| (part.made_least, part.made_most);
        let entry = match state.unfinished {
            Some(now) if now.intent == lost.intent && made(&now) != made(&lost) => {
                self.entry_of(&now, LogEnd::Fault)
            }
            None if why == Why::Met => {
                let all = lost.intent.steps.abs();
                let cause = Some("by the board alone, out of reach of the program".to_owned());
                LogEntry { cause, ..self.entry_of(&Unfinished::of(&lost.intent, all, all), LogEnd::Done) }
            }
            _ => return None,
        };
        let first = self.bench.folder().log().last_of(|first| first.number == number);
        let Some((_, first)) = first.ok().flatten() else {
            return Some(LogEntry { counted_later: true, ..entry });
        };
        let is_done = entry.end == LogEnd::Done;
        Some(LogEntry {
            counted_later: true,
            time: first.time,
            requested_ml: first.requested_ml,
            end: if is_done { entry.end } else { first.end },
            cause: if is_done { entry.cause } else { first.cause },
            motion_s: first.motion_s,
            steps: entry.steps.filter(|_| !lost.intent.terms.by_weight),
            ..entry
        })
    }

    /// Returns a motion that an earlier process left, with the steps that a rest in `state` finds it made.
    fn found(&self, left: &Unfinished, why: Why, state: &PumpState) -> Unfinished {
        let made = |made_least, made_most| Unfinished { made_least, made_most, ..*left };
        let all = left.intent.steps.abs();
        match state.unfinished {
            Some(now) if now.intent.told == left.intent.told && now.intent.unix_s == left.intent.unix_s => {
                now
            }
            // The device has made the motion that the process could not end.
            None if why == Why::Met && left.intent.purpose.is_delivery() => made(all, all),
            _ => *left,
        }
    }

    /// Returns the entry of a motion. `None` for a turn that [`Self::told`] has nothing of, and for a stretch of a dose
    /// by weight.
    fn entry(&self, part: &Unfinished, end: LogEnd) -> Option<LogEntry> {
        let intent = &part.intent;
        let is_own = (intent.purpose != Purpose::Jog || intent.told.is_some()) && !intent.terms.by_weight;
        is_own.then(|| self.entry_of(part, end))
    }

    /// Returns the entry of `part`, whatever its purpose.
    fn entry_of(&self, part: &Unfinished, end: LogEnd) -> LogEntry {
        let (model, tube, number) = (self.bench.model(), self.stands().tube(), self.log.doses + 1);
        LogEntry::of(part, model, end, tube, number, self.part_uncertainty_ml(part))
    }

    /// Returns the expanded uncertainty of the most steps that a motion on record may have made, in mL. `None` for a
    /// motion whose plan had none.
    pub(crate) fn part_uncertainty_ml(&self, part: &Unfinished) -> Option<f64> {
        let intent = &part.intent;
        let whole_ml = intent.told?.expanded_uncertainty_ml?;
        let (made, all) = (part.made_most.max(0).unsigned_abs(), intent.steps.unsigned_abs());
        if made >= all {
            return Some(whole_ml);
        }
        let prepared = self.bench.planned_anew(self.file(), intent);
        Some(prepared.map_or(whole_ml, |prepared| self.expanded_ml(&prepared, made)))
    }

    /// Returns the expanded uncertainty of the first `made` steps, in mL. `None` for a motion that was not prepared.
    fn uncertainty_ml(&self, motion: &RecordedMotion<'_>, made: u64) -> Option<f64> {
        let prepared = motion.prepared.filter(|_| !motion.terms.by_weight)?;
        if let PlannedMotion::Flow(flow) = motion.plan {
            let part = Swept::flow(&prepared.model, flow, made);
            let backflow_ml = prepared.backflow_in_ml(motion.plan, made);
            let backflow_ml = backflow_ml.unwrap_or(prepared.back_flow.backflow_ml);
            return Some(prepared.budget(self.bench.file(), &part, backflow_ml).expanded_ml());
        }
        Some(self.expanded_ml(prepared, made))
    }

    /// Returns the expanded uncertainty of the first `made` steps of a dose, in mL.
    fn expanded_ml(&self, prepared: &Prepared, made: u64) -> f64 {
        let (model, plan) = (&prepared.model, &prepared.plan);
        let is_whole = made == plan.steps().unsigned_abs();
        let part = if is_whole { Swept::whole(model, plan) } else { Swept::part(model, plan, made) };
        let backflow_ml = prepared.backflow_of_ml(made).unwrap_or(prepared.back_flow.backflow_ml);
        prepared.budget(self.bench.file(), &part, backflow_ml).expanded_ml()
    }
}
