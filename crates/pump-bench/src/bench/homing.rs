//! Finding the rollers' angle: by hand, by a mark, by an index sensor.

use std::ops::ControlFlow;
use std::path::PathBuf;

use pump_ctl::plan::{Phase, Plan, turn};
use pump_model::math::{ceil, degrees, floor, rad_s, radians};

use super::bench::Bench;
use crate::displacement::Correction;
use crate::dosing::DoseError;
use crate::record::{JournalError, State, Terms, Why};
use crate::record::{PhaseSource, Purpose};

use super::recorded_motion::{Moved, RecordedMotion};
use super::session::Session;

/// Speed of a search for the index, r/min: what stops within a degree on any motor, and a revolution takes six seconds.
const SEEK_RPM: f64 = 10.0;

/// An angle that was set.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleSet {
    /// How things stand now.
    pub state: State,
    /// What doses owed and is forgotten, mL.
    pub owed_ml: f64,
    /// Where a journal that could not be read is now.
    pub aside: Option<PathBuf>,
}

impl Bench {
    /// Takes the pump and records that the rotor stands at `phase`, as [`Session::set_angle`] does. A journal that cannot be
    /// read is moved aside, and put back if the angle cannot be recorded all the same.
    pub fn set_angle(&self, phase: Option<Phase>) -> Result<(Session<'_>, AngleSet), DoseError> {
        let aside = match self.session() {
            Err(DoseError::Journal(JournalError::Damaged { .. })) => {
                self.folder().lock()?.set_journal_aside()?
            }
            session => {
                let mut session = session?;
                let owed_ml = session.owed_ml();
                let state = session.set_angle(phase)?;
                return Ok((session, AngleSet { state, owed_ml, aside: None }));
            }
        };
        let set = self.session().and_then(|mut session| {
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
    /// Records that the rotor stands at `phase`; `None`: nobody knows where. What doses owe is zero afterwards. Refused
    /// with a dose unfinished.
    pub fn set_angle(&mut self, phase: Option<Phase>) -> Result<State, DoseError> {
        self.finished()?;
        self.find(phase, PhaseSource::Home, Why::Set)
    }

    /// Turns the rotor by `steps` (negative in reverse, not zero) at `speed_rad_s` or what the device allows of it. Owes
    /// nothing and repays nothing. Returns how many steps were made. Refused with a dose unfinished.
    pub fn jog(
        &mut self,
        steps: i64,
        speed_rad_s: f64,
        watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<u64, DoseError> {
        self.connect()?;
        let plan = self.planned_turn(steps, speed_rad_s)?;
        Ok(self.turn(&plan, false, watch)?.made)
    }

    /// Whole steps nearest to a turn by `turn_rad`, one at least.
    pub fn steps_of(&self, turn_rad: f64) -> i64 {
        let steps = floor(turn_rad / self.bench.file().limits().motor.step_rad() + 0.5) as i64;
        if steps == 0 { turn_rad.signum() as i64 } else { steps }
    }

    /// Angle at which the rotor's mark meets the housing's, rad.
    pub fn mark_rad(&self) -> Result<f64, DoseError> {
        self.bench
            .file()
            .pump
            .mark_angle_deg
            .map(radians)
            .ok_or_else(|| self.no_angle("[pump] mark_angle_deg", "the rotor's mark and the housing's meet"))
    }

    /// Records that the rotor's mark meets the housing's, within `half_width_rad`. What doses owe is zero afterwards.
    pub fn set_at_mark(&mut self, half_width_rad: f64) -> Result<State, DoseError> {
        self.finished()?;
        let phase = Phase { angle_rad: self.mark_rad()?, half_width_rad };
        self.find(Some(phase), PhaseSource::Mark, Why::Mark)
    }

    /// Angle at which the index sensor answers, rad. Refused without one.
    pub fn index_rad(&mut self) -> Result<f64, DoseError> {
        self.connect()?;
        self.need_index()?;
        let angle_deg = self.bench.drive().index_angle_deg;
        angle_deg
            .map(radians)
            .ok_or_else(|| self.no_angle("[drive] index_angle_deg", "the rotor and its sensor meet"))
    }

    /// Turns forward, a revolution at most, until the index sensor answers, and records where the rotor then stands. What
    /// doses owe is zero afterwards. `None` if `watch` broke before it was found. Refused with a dose unfinished.
    pub fn seek_index(
        &mut self,
        watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Option<State>, DoseError> {
        let index_rad = self.index_rad()?;
        let steps = ceil(self.bench.file().limits().motor.steps_per_rev) as i64;
        let plan = self.planned_turn(steps, rad_s(SEEK_RPM))?;
        let before = self.stands().disturbances;
        let Moved { made, beyond, .. } = self.turn(&plan, true, watch)?;
        let disturbed = self.stands().disturbances > before;
        match beyond {
            Some(beyond) => {
                let phase = Phase {
                    angle_rad: index_rad + beyond as f64 * plan.step_rad,
                    half_width_rad: radians(self.bench.drive().index_width_deg) + 0.5 * plan.step_rad,
                };
                let found = self.stands().found(phase, PhaseSource::Home);
                // A board that lets go of the motor after each motion has done so after this one.
                let pitch_rad = self.bench.model().pitch_rad();
                let state = if disturbed { found.disturbed(self.bench.fall_rad(), pitch_rad) } else { found };
                self.record_angle(Why::Sensor, state).map(Some)
            }
            None if made == plan.steps.unsigned_abs() => {
                let turned_deg = degrees(made as f64 * plan.step_rad);
                Err(DoseError::NoIndex { turned_deg, pumped_ml: plan.planned_ml })
            }
            None => Ok(None),
        }
    }

    fn planned_turn(&self, steps: i64, speed_rad_s: f64) -> Result<Plan, DoseError> {
        let stands = self.finished()?.phase();
        let limits = self.file().limits();
        let least_rad_s = self.device.as_ref().map_or(0.0, |device| device.least_rad_s());
        let speed_rad_s = speed_rad_s.max(least_rad_s).min(limits.motor.max_speed_rad_s);
        Ok(turn(self.bench.model(), stands, steps, speed_rad_s, &limits)?)
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
            plan,
            model,
            correction,
            purpose,
            carry_out_ml,
            given: false,
            retract_ml: None,
            terms: Terms::default(),
            settle_s: 0.0,
            seeks,
        };
        self.perform(&motion, watch)
    }

    /// Records where the rotor was found.
    fn find(&mut self, phase: Option<Phase>, source: PhaseSource, why: Why) -> Result<State, DoseError> {
        self.connect()?;
        let phase = phase.unwrap_or(Phase::unknown(self.bench.model().pitch_rad()));
        let state = self.stands().found(phase, source);
        self.record_angle(why, state)
    }

    /// Records the angle. The error says whether the rotor was turned before.
    fn record_angle(&mut self, why: Why, state: State) -> Result<State, DoseError> {
        let angle_deg = degrees(state.angle_rad);
        match self.rest(why, state) {
            Ok(()) => Ok(state),
            Err(source) if self.has_moved => Err(DoseError::AngleNotRecorded { angle_deg, source }),
            Err(source) => Err(source.into()),
        }
    }

    fn no_angle(&self, key: &'static str, what: &'static str) -> DoseError {
        DoseError::NoAngle { pump: self.bench.file().pump.id.clone(), key, what }
    }
}
