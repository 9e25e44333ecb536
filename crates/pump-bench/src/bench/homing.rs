//! Homing: finding the rotor's angle by hand, by a mark, or by an index sensor.

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

/// Speed of a search for the index, in r/min. Any motor stops from it within a degree, and a revolution takes
/// six seconds.
const SEEK_RPM: f64 = 10.0;

/// Result of setting the angle.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleSet {
    /// State of the pump now.
    pub state: State,
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
    /// Records that the rotor stands at `phase`. `None` means that its angle is unknown. The carry is zero
    /// afterwards.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if a dose is unfinished, the device cannot be used, or the angle cannot be recorded.
    pub fn set_angle(&mut self, phase: Option<Phase>) -> Result<State, DoseError> {
        self.finished()?;
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
    pub fn set_at_mark(&mut self, half_width_rad: f64) -> Result<State, DoseError> {
        self.finished()?;
        let phase = Phase { angle_rad: self.mark_rad()?, half_width_rad };
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

    /// Turns forward until the index sensor answers, a revolution at most, and records where the rotor then
    /// stands.
    ///
    /// The carry is zero afterwards. Returns `None` if `watch` broke before the index was found.
    ///
    /// # Errors
    ///
    /// [`DoseError::NoIndex`] if the sensor did not answer within a revolution. Other [`DoseError`]s if a
    /// dose is unfinished, the device cannot be used or fails, or the angle cannot be recorded.
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
                // A board that releases the motor after each motion has done so after this one.
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

    /// Records the angle. The error tells if the rotor was turned before.
    fn record_angle(&mut self, why: Why, state: State) -> Result<State, DoseError> {
        let angle_deg = degrees(state.angle_rad);
        match self.rest(why, state) {
            Ok(()) => Ok(state),
            Err(source) if self.moved => Err(DoseError::AngleNotRecorded { angle_deg, source }),
            Err(source) => Err(source.into()),
        }
    }

    fn no_angle(&self, key: &'static str, what: &'static str) -> DoseError {
        DoseError::NoAngle { pump: self.bench.file().pump.id.clone(), key, what }
    }
}
