//! Homing: finding the rotor's angle by hand, by a mark, or by an index sensor.

use std::ops::ControlFlow;
use std::path::PathBuf;

use libm::{ceil, floor};
use pump_ctl::plan::{Doser, Limits, Phase, Plan};
use pump_model::units::{degrees, rad_s, radians};

use super::bench::Bench;
use crate::displacement::Correction;
use crate::dosing::{DisplacedPumps, DoseError};
use crate::drives::Drive;
use crate::notice::{Notice, Remedy};
use crate::numbers::significant;
use crate::record::{DoseTerms, JournalError, PumpState, Why};
use crate::record::{PhaseSource, Purpose};

use super::recorded_motion::{Moved, RecordedMotion};
use super::session::Session;

/// Speed of a search for the index, in r/min. Any motor stops from it within a degree, and a revolution takes
/// six seconds.
const SEEK_RPM: f64 = 10.0;

/// Share of a turn to the index sensor in the dose that it interrupts.
pub(super) const NOT_DELIVERED: &str = "counts as not delivered by the unfinished dose";

/// Result of setting the angle.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct AngleSet {
    /// State of the pump now.
    pub state: PumpState,
    /// Carry that was dropped, in mL.
    pub owed_ml: f64,
    /// New path of a journal that could not be read.
    pub aside: Option<PathBuf>,
}

impl Bench {
    /// Takes the pump and records that the rotor stands at `phase`, as [`Session::set_angle`] does.
    ///
    /// An unreadable journal is set aside. If the angle cannot be recorded all the same, the journal is put
    /// back.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if another process holds the pump, a dose is unfinished, or the angle cannot be
    /// recorded.
    pub fn set_angle(&self, phase: Option<Phase>) -> Result<(Session<'_>, AngleSet), DoseError> {
        self.set_angle_by(None, phase)
    }

    /// Records that the rotor that `drive` turns stands at `phase`, as [`Self::set_angle`] does.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as for [`Self::set_angle`] and [`Session::with_drive`].
    pub fn set_angle_with_drive<'a>(
        &'a self,
        drive: Box<dyn Drive + 'a>,
        phase: Option<Phase>,
    ) -> Result<(Session<'a>, AngleSet), DoseError> {
        self.set_angle_by(Some(drive), phase)
    }

    fn set_angle_by<'a>(
        &'a self,
        mut drive: Option<Box<dyn Drive + 'a>>,
        phase: Option<Phase>,
    ) -> Result<(Session<'a>, AngleSet), DoseError> {
        if let Some(drive) = &drive {
            self.check_drive(drive.as_ref())?;
        }
        let aside = match self.session() {
            Err(DoseError::Journal(JournalError::Damaged { .. })) => {
                self.folder().lock()?.set_journal_aside()?
            }
            session => {
                let mut session = session?;
                session.give(drive);
                let owed_ml = session.owed_ml();
                let state = session.set_angle(phase)?;
                // The carry of an unfinished dose stays.
                let owed_ml = owed_ml - state.carry_ml;
                return Ok((session, AngleSet { state, owed_ml, aside: None }));
            }
        };
        let set = self.session().and_then(|mut session| {
            session.give(drive.take());
            let state = session.set_angle(phase)?;
            Ok((session, state))
        });
        match set {
            Ok((session, state)) => Ok((session, AngleSet { state, owed_ml: 0.0, aside: Some(aside) })),
            Err(error) => {
                self.folder().lock()?.put_journal_back(&aside)?;
                Err(error)
            }
        }
    }
}

impl Session<'_> {
    /// Records that the rotor stands at `phase`. `None` means that its angle is unknown. The carry is zero
    /// afterwards.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if a dose is unfinished, the device cannot be used, or the angle cannot be recorded.
    pub fn set_angle(&mut self, phase: Option<Phase>) -> Result<PumpState, DoseError> {
        self.may_find_angle()?;
        phase.map_or(Ok(()), |phase| phase.validate())?;
        self.find(phase, PhaseSource::Home, Why::Set)
    }

    /// Turns the rotor by `steps` (negative in reverse, not zero) at `speed_rad_s` or the nearest speed that
    /// the device allows. The carry stays. Returns the number of steps made.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if a dose is unfinished, the device cannot be used or fails, or the motion cannot be
    /// recorded.
    pub fn jog(
        &mut self,
        steps: i64,
        speed_rad_s: f64,
        watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<u64, DoseError> {
        self.check_confirmed()?;
        self.connect()?;
        let plan = self.planned_turn(steps, speed_rad_s)?;
        Ok(self.turn(&plan, false, watch)?.made)
    }

    /// Returns the whole number of steps nearest to a turn by `turn_rad`, at least one.
    pub fn steps_of(&self, turn_rad: f64) -> i64 {
        let steps = floor(turn_rad / self.bench.file().limits().motor.step_rad() + 0.5) as i64;
        if steps == 0 { turn_rad.signum() as i64 } else { steps }
    }

    /// Returns the angle at which the rotor's mark meets the housing's, in rad.
    ///
    /// # Errors
    ///
    /// [`DoseError::NoAngle`] if the pump file does not give the angle.
    pub fn mark_rad(&self) -> Result<f64, DoseError> {
        self.bench
            .file()
            .pump
            .mark_angle_deg
            .map(radians)
            .ok_or_else(|| self.no_angle("[pump] mark_angle_deg", "the rotor's mark meets the housing's"))
    }

    /// Records that the rotor's mark meets the housing's, within `half_width_rad`. The carry is zero
    /// afterwards.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if a dose is unfinished, the pump file gives no angle of the mark, or the angle cannot
    /// be recorded.
    pub fn set_at_mark(&mut self, half_width_rad: f64) -> Result<PumpState, DoseError> {
        self.may_find_angle()?;
        let phase = Phase::within(self.mark_rad()?, half_width_rad);
        self.find(Some(phase), PhaseSource::Mark, Why::Mark)
    }

    /// Returns the angle at which the index sensor answers, in rad.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if the device cannot be used or has no sensor, or the pump file does not give the angle.
    pub fn index_rad(&mut self) -> Result<f64, DoseError> {
        self.connect()?;
        self.need_index()?;
        let angle_deg = self.bench.drive().index_angle_deg;
        angle_deg
            .map(radians)
            .ok_or_else(|| self.no_angle("[drive] index_angle_deg", "the index sensor answers"))
    }

    /// Returns what to tell a person before a turn to the index sensor while a dose is unfinished: the most that it
    /// pumps, and where the tube's end belongs. `None` if no dose is unfinished.
    pub fn search_warning(&self) -> Option<Notice> {
        let dose = self.stands().unfinished?;
        let most_ml = self.bench.model().revolution_ml();
        Some(Notice::from(format!(
            "a dose of {} mL is unfinished, and this turn is no part of it: it pumps up to {} mL, of which nothing is \
             to get into the vessel; put the tube's end over waste first",
            significant(dose.intent.whole_requested_ml(), 6),
            significant(most_ml, 3),
        )))
    }

    /// Turns forward until the index sensor answers, a revolution at most, and records where the rotor then
    /// stands.
    ///
    /// While a dose is unfinished, the turn counts as not delivered, and a note tells what it pumped.
    /// [`Self::search_warning`] is to be told before. The carry is zero afterwards. Returns `None` if `watch` broke
    /// before the index was found.
    ///
    /// # Errors
    ///
    /// [`DoseError::NoIndex`] if the sensor did not answer within a revolution. Other [`DoseError`]s if a
    /// dose is unfinished, the device cannot be used or fails, or the angle cannot be recorded.
    pub fn seek_index(
        &mut self,
        watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Option<PumpState>, DoseError> {
        let before = self.stands().unfinished.map(|dose| dose.searched_ml());
        let sought = self.turn_to_index(watch);
        let after = self.stands().unfinished.map(|dose| dose.searched_ml());
        if let Some(pumped_ml) =
            before.zip(after).map(|(before, after)| after - before).filter(|ml| *ml != 0.0)
        {
            self.notes.push(Notice::from(format!(
                "the turn to the index sensor pumped {} mL, which {NOT_DELIVERED}",
                significant(pumped_ml, 3)
            )));
        }
        sought
    }

    /// Turns to the index sensor as [`Self::seek_index`] does, without a note.
    pub(super) fn turn_to_index(
        &mut self,
        watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Option<PumpState>, DoseError> {
        self.check_confirmed()?;
        let index_rad = self.index_rad()?;
        let steps = ceil(self.bench.file().limits().motor.steps_per_rev) as i64;
        let plan = self.planned_turn(steps, rad_s(SEEK_RPM))?;
        let before = self.stands().disturbances;
        let Moved { made, beyond, .. } = self.turn(&plan, true, watch)?;
        let disturbed = self.stands().disturbances > before;
        match beyond {
            Some(beyond) => {
                let phase = Phase::within(
                    index_rad + beyond as f64 * plan.step_rad(),
                    radians(self.bench.drive().index_width_deg) + 0.5 * plan.step_rad(),
                );
                let model = self.bench.model();
                let found = self.stands().found(Some(phase), PhaseSource::Home, model);
                // A board that releases the motor after each motion has done so after this one.
                let state = if disturbed { found.disturbed(self.bench.fall_rad(), model) } else { found };
                self.record_angle(Why::Sensor, state).map(Some)
            }
            None if made == plan.steps().unsigned_abs() => {
                let turned_deg = degrees(made as f64 * plan.step_rad());
                Err(DoseError::NoIndex { turned_deg, pumped_ml: plan.planned_ml() })
            }
            None => Ok(None),
        }
    }

    /// Returns the state of the pump, if the angle may be found: no dose is unfinished, or the session may home
    /// with an unfinished dose whose angle is not known exactly.
    fn may_find_angle(&self) -> Result<PumpState, DoseError> {
        let state = self.stands();
        match state.unfinished {
            Some(_) if self.may_home_unfinished && state.half_width_rad > 0.0 => Ok(state),
            Some(_) if self.may_home_unfinished => Err(DoseError::AngleIsKnown),
            _ => self.finished(),
        }
    }

    fn planned_turn(&self, steps: i64, speed_rad_s: f64) -> Result<Plan, DoseError> {
        let stands = self.may_find_angle()?.phase();
        let limits = self.file().limits();
        let least_rad_s = self.device.as_ref().map_or(0.0, |device| device.least_rad_s());
        let speed_rad_s = speed_rad_s.max(least_rad_s).min(limits.motor.max_speed_rad_s);
        let model = self.bench.model();
        let plan = Doser::new(model, Limits::new(limits.motor))?.turn(stands, steps, speed_rad_s)?;
        let stored = self.bench.calibrations().active()?;
        let signed_rad_s = speed_rad_s.copysign(steps as f64);
        let displaced = DisplacedPumps::at(self.bench.file(), model, stored.as_ref(), signed_rad_s)?;
        displaced.check(&plan, &limits)?;
        Ok(plan)
    }

    fn turn(
        &mut self,
        plan: &Plan,
        seeks: bool,
        watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Moved, DoseError> {
        let carry_out_ml = self.stands().carry_ml;
        let (model, correction) = (self.bench.model(), Correction::NONE);
        let purpose = Purpose::Jog;
        let motion = RecordedMotion {
            plan: plan.into(),
            announced: None,
            prepared: None,
            model,
            correction,
            purpose,
            carry_out_ml,
            given: false,
            retract_ml: None,
            whole: None,
            terms: DoseTerms::default(),
            settle_s: None,
            seeks,
            may_pause: true,
        };
        self.perform(&motion, watch)
    }

    /// Records where the rotor was found.
    fn find(&mut self, phase: Option<Phase>, source: PhaseSource, why: Why) -> Result<PumpState, DoseError> {
        self.connect()?;
        self.record_meeting()?;
        let state = self.confirmed(self.stands().found(phase, source, self.bench.model()));
        let recorded = self.record_angle(why, state)?;
        if phase.is_some() {
            // The device was met with an angle that was less sure, and now it is found.
            self.notes.iter_mut().for_each(|note| note.drop_remedy(Remedy::FindAngle));
        }
        Ok(recorded)
    }

    /// Records the angle. The error tells if the rotor was turned before.
    fn record_angle(&mut self, why: Why, state: PumpState) -> Result<PumpState, DoseError> {
        match self.rest(why, state) {
            Ok(()) => Ok(state),
            Err(source) if self.moved => Err(not_recorded(&state, self.bench.model().pitch_rad(), source)),
            Err(source) => Err(source.into()),
        }
    }

    fn no_angle(&self, key: &'static str, what: &'static str) -> DoseError {
        DoseError::NoAngle { pump: self.bench.file().pump.id.clone(), key, what }
    }
}

/// Returns the error of a rotor that was turned and whose state could not be recorded. It names the angle if that is
/// known.
fn not_recorded(state: &PumpState, pitch_rad: f64, source: JournalError) -> DoseError {
    let angle_deg = state.phase().is_known(pitch_rad).then(|| degrees(state.angle_rad));
    DoseError::AngleNotRecorded { angle_deg, source }
}

#[cfg(test)]
mod tests {
    use std::io::ErrorKind;

    use super::*;

    #[test]
    fn an_angle_that_nobody_knows_is_not_named_where_it_cannot_be_recorded() {
        let pitch_rad = radians(120.0);
        let said = |phase, cause: ErrorKind| {
            let state = PumpState::fresh(phase, PhaseSource::Home);
            let path = PathBuf::from("journal.jsonl");
            let source = JournalError::File { action: "write", path, source: cause.into() };
            crate::report::with_sources(&not_recorded(&state, pitch_rad, source))
        };
        let unknown = said(Phase::unknown(pitch_rad), ErrorKind::StorageFull);
        assert!(
            unknown.starts_with("the rotor was turned and nobody knows its angle, but this"),
            "{unknown}"
        );
        let known = said(Phase::known(radians(30.0)), ErrorKind::PermissionDenied);
        assert!(known.starts_with("the rotor was turned and stands at 30.0000 deg, but this"), "{known}");
        assert!(known.contains("permission denied"), "{known}");
    }
}
