//! The rehearsal of a rack: every step of every pump is planned, and nothing moves.

use super::clock::SharedStop;
use super::error::RackError;
use super::rack::Rack;
use super::report::{RackDose, RackEnd, RackPumpReport, RackReport};
use super::timetable::{LineSpeeds, Timetable, Timing};
use crate::bench::{Bench, Delivered, SeriesMotion, SeriesRequest, TimedVolume};
use crate::dosing::DoseError;
use crate::drives::DriveError;
use crate::report::{DoseReport, Ending};

impl Rack {
    /// Plans every step of every pump from the records and checks it against all limits. Moves and records nothing, and
    /// asks no device.
    ///
    /// # Errors
    ///
    /// [`RackError`] of the first step that cannot be run, and of each pump that waits for a person.
    pub fn rehearse(&self) -> Result<RackReport, RackError> {
        let mut plans = Vec::new();
        for (pump, member) in self.members().iter().enumerate() {
            match member.bench.prepare_series(&self.requests(pump)) {
                Ok(prepared) => plans.push(prepared),
                Err(refused) => return Err(self.with_waiting(pump, self.refused(pump, refused))),
            }
        }
        let own = plans.iter().map(|prepared| timings(prepared)).collect();
        let (timetable, timings) = LineSpeeds::settle(self, own, |speeds, slowed, told| {
            for pump in slowed {
                let prepared = self.members()[*pump].bench.prepare_series(&speeds.requests(self, *pump));
                plans[*pump] = prepared.map_err(|refused| self.refused(*pump, refused))?;
                told[*pump] = timings(&plans[*pump]);
            }
            Ok(())
        })?;
        let mut rows = Vec::new();
        for (pump, (member, prepared)) in self.members().iter().zip(&plans).enumerate() {
            let series = self.series(pump, &timetable, &timings[pump]);
            if let Err(error) = member.bench.check_series_safe(&series) {
                return Err(self.with_waiting(pump, self.dose_error(pump, None, error)));
            }
            let parts = self.parts(pump).zip(prepared).map(|(step, prepared)| RackDose {
                step: step + 1,
                begin_s: timetable.begins_s[step],
                unfinished: false,
                dose: report(&member.bench, prepared, None),
            });
            rows.push(RackPumpReport::of(member, prepared.len(), self.requested_ml(pump), parts.collect()));
        }
        Ok(RackReport::of(self, RackEnd::Planned, None, timetable.ends_s, rows))
    }

    /// Refuses what the records alone refuse. A pump whose last motion was cut off is left to the run, because its
    /// device may tell more of that motion than the record does.
    pub(super) fn check_records(&self) -> Result<(), RackError> {
        let refused = |pump: usize, refused| Err(self.with_waiting(pump, self.refused(pump, refused)));
        let mut known = Vec::new();
        for (pump, member) in self.members().iter().enumerate() {
            match member.bench.check_before_meeting() {
                Ok(is_cut_off) => known.extend((!is_cut_off).then_some((pump, member))),
                Err(error) => return refused(pump, (0, error)),
            }
        }
        if known.len() == self.members().len() {
            return self.rehearse().map(drop);
        }
        known.into_iter().try_for_each(|(pump, member)| {
            let checked = member.bench.check_waiting().map_err(|error| (0, error));
            let planned = checked.and_then(|()| member.bench.prepare_series(&self.requests(pump)));
            planned.map(drop).or_else(|error| refused(pump, error))
        })
    }

    /// Returns the numbers of the steps in which a pump takes part, from 0.
    pub(super) fn parts(&self, pump: usize) -> impl Iterator<Item = usize> {
        let takes_part = move |step: &super::step::RackStep| step.flows.iter().any(|flow| flow.pump == pump);
        self.steps().iter().enumerate().filter(move |(_, step)| takes_part(step)).map(|(number, _)| number)
    }

    /// Returns the requests to a pump in the order of its steps.
    pub(super) fn requests(&self, pump: usize) -> Vec<SeriesRequest> {
        let of = |step: &super::step::RackStep| {
            step.flows.iter().find(|flow| flow.pump == pump).map(|flow| flow.request(step.smooth))
        };
        self.steps().iter().filter_map(of).collect()
    }

    /// Returns the volume that all steps ask of a pump, in mL.
    pub(super) fn requested_ml(&self, pump: usize) -> f64 {
        self.requests(pump).iter().map(|asked| asked.request.volume_ml).sum()
    }

    /// Returns the volumes of a pump with their times.
    pub(super) fn series(&self, pump: usize, times: &Timetable, timings: &[Timing]) -> Vec<TimedVolume> {
        let timed = |(step, timing): (usize, &Timing)| TimedVolume {
            at_s: times.begins_s[step],
            volume_ml: timing.planned_ml,
        };
        self.parts(pump).zip(timings).map(timed).collect()
    }

    /// Returns the refusal of a pump's part, by its place among the pump's parts.
    pub(super) fn refused(&self, pump: usize, (place, source): (usize, DoseError)) -> RackError {
        let is_of_record = match &source {
            // A step asks for more than the drive does.
            DoseError::Connection(DriveError::Unable { .. }) => false,
            DoseError::Folder(_)
            | DoseError::Journal(_)
            | DoseError::Stands { .. }
            | DoseError::Connection(_)
            | DoseError::Unconfirmed { .. }
            | DoseError::TurnedOtherwise { .. } => true,
            _ => false,
        };
        let is_of_step = !is_of_record && source.ending() != Ending::Unfinished;
        let step = self.parts(pump).nth(place).filter(|_| is_of_step).map(|step| step + 1);
        self.dose_error(pump, step, source)
    }

    /// Returns the error of a pump.
    pub(super) fn dose_error(&self, pump: usize, step: Option<usize>, source: DoseError) -> RackError {
        RackError::Dose { pump: self.members()[pump].name.clone(), step, source: Box::new(source) }
    }

    /// Returns the refusal of a pump whose record says that it waits for a person. `None` if it does not.
    pub(super) fn waiting(&self, pump: usize) -> Option<RackError> {
        let waits = self.members()[pump].bench.check_waiting().err()?;
        Some(self.refused(pump, (0, waits)))
    }

    /// Returns the refusal of a pump, with those of all others that wait for a person.
    fn with_waiting(&self, pump: usize, refused: RackError) -> RackError {
        let waiting = |other: usize| self.waiting(other);
        let mut refusals: Vec<RackError> = (0..pump).filter_map(waiting).collect();
        refusals.push(refused);
        refusals.extend((pump + 1..self.members().len()).filter_map(waiting));
        let first = refusals.remove(0);
        first.with_waiting(refusals)
    }

    /// Returns the stop that all pumps hear.
    pub(super) fn shared_stop(&self) -> SharedStop {
        let names = self.members().iter().map(|member| member.name.clone());
        SharedStop::hearing(self.stop.clone(), names.collect())
    }
}

/// Returns the times of planned motions.
pub(super) fn timings(motions: &[SeriesMotion]) -> Vec<Timing> {
    let of = |motion: &SeriesMotion| {
        let settle_s = motion.whole().prediction.settle_s;
        Timing {
            motion_s: motion.motion_s(),
            // Nobody waits for a line that does not come to rest.
            settle_s: if settle_s.is_finite() { settle_s } else { 0.0 },
            planned_ml: motion.planned_ml(),
            turn_rad: motion.turn_rad(),
            at_peak_s: motion.turn_rad() / motion.peak_rad_s(),
            share: None,
        }
    };
    motions.iter().map(of).collect()
}

/// Reports a motion that was planned or made.
pub(super) fn report(bench: &Bench, motion: &SeriesMotion, delivered: Option<&Delivered>) -> DoseReport {
    match motion {
        SeriesMotion::Dose(prepared) => DoseReport::new(bench, prepared, delivered),
        SeriesMotion::Flow(prepared) => DoseReport::by_profile(bench, prepared, delivered),
    }
}
