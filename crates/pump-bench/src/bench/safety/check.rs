//! The check of a motion against the safety limits, before it begins.

use super::timed_volume::TimedVolume;
use crate::bench::bench::Bench;
use crate::bench::session::Session;
use crate::dosing::DoseError;
use crate::notice::Notice;
use crate::record::{Clock, PumpState, SystemClock, Why};
use crate::safety::{SafetyAccount, SafetyLimit, SafetyLimits, Stand, clock_behind};

/// Volume by which doses may exceed a limit, in mean motor steps: a dose ends within one of what was asked for.
const WITHIN_STEPS: f64 = 2.0;

/// Returns the time of the system's clock, in seconds since 1970.
pub(crate) fn system_now_s() -> u64 {
    SystemClock.now().unix_s
}

impl Bench {
    /// Returns the safety limits of the pump file, each with the rounding of a dose to motor steps.
    pub(in crate::bench) fn safety_limits(&self) -> SafetyLimits {
        let (table, steps_per_rev) = (&self.file().safety, self.file().limits().motor.steps_per_rev);
        let rounding_ml = WITHIN_STEPS * self.model().revolution_ml() / steps_per_rev;
        let rounded = |volume_ml: Option<f64>| volume_ml.map(|volume_ml| volume_ml + rounding_ml);
        SafetyLimits::new(rounded(table.max_ml_per_day), rounded(table.vessel_ml))
    }

    /// Returns the account of the volumes that safety limits count, if `state` is on record.
    pub(crate) fn safety_account(&self, state: Option<&PumpState>, now_s: u64) -> SafetyAccount {
        state.copied().unwrap_or(self.fresh()).safety_at(now_s)
    }

    /// Returns the safety limit that leaves the least to a motion, with what is used of it. `None` without limits.
    pub(in crate::bench) fn nearest_limit(
        &self,
        state: Option<&PumpState>,
        now_s: u64,
        reverse: bool,
    ) -> Option<Stand> {
        self.safety_account(state, now_s).nearest(&self.safety_limits(), now_s, reverse)
    }

    /// Refuses a plan of `planned_ml` that a session would refuse now. Nothing is recorded: the pump may move on.
    ///
    /// # Errors
    ///
    /// [`DoseError::Stands`] with the limit.
    pub(in crate::bench) fn would_be_safe(
        &self,
        state: Option<&PumpState>,
        planned_ml: f64,
    ) -> Result<(), DoseError> {
        self.would_all_be_safe(state, &[TimedVolume { at_s: 0.0, volume_ml: planned_ml }])
    }

    /// Refuses a pump that waits for a person, by its record alone: it stands, or a dose is unfinished. The dose of a
    /// pump that another process holds may be under way.
    pub(crate) fn check_waiting(&self) -> Result<(), DoseError> {
        if self.is_held() || self.plans_afresh() {
            return Ok(());
        }
        let (state, now_s) = (self.story()?.state, system_now_s());
        let account = self.safety_account(state.as_ref(), now_s);
        match account.stand {
            Some(stand) => Err(self.refusal(stand, false, account.behind_s(now_s))),
            None => self.refuse_unfinished(state),
        }
    }

    /// Returns the stand of a run until it is stopped to which a safety limit leaves nothing. Nobody asked a volume of
    /// it. `None` if it may begin.
    pub(in crate::bench) fn used_up(&self, nearest: Option<Stand>, now_s: u64) -> Option<Stand> {
        let step_ml = self.model().revolution_ml() / self.file().limits().motor.steps_per_rev;
        let stand = nearest.filter(|stand| stand.left_ml() <= 2.0 * WITHIN_STEPS * step_ml)?;
        Some(Stand { planned_ml: 0.0, unix_s: now_s, ..self.as_said(stand) })
    }

    /// Refuses a run until it is stopped that [`Session::keep_run_safe`] would refuse. Nothing is recorded.
    pub(in crate::bench) fn would_run(&self, nearest: Option<Stand>, now_s: u64) -> Result<(), DoseError> {
        let Some(stand) = self.used_up(nearest, now_s) else { return Ok(()) };
        Err(unrecorded(self.refusal(stand, true, 0)))
    }

    /// Refuses a series of volumes that a session would refuse now, as [`Session::keep_series_safe`] does. Nothing is
    /// recorded.
    ///
    /// # Errors
    ///
    /// [`DoseError::Stands`] with the limit. [`DoseError::Journal`] if the record cannot be read.
    pub fn check_series_safe(&self, series: &[TimedVolume]) -> Result<(), DoseError> {
        self.would_all_be_safe(self.state_to_plan()?.as_ref(), series)
    }

    fn would_all_be_safe(&self, state: Option<&PumpState>, series: &[TimedVolume]) -> Result<(), DoseError> {
        let (now_s, account) = (system_now_s(), self.safety_account(state, system_now_s()));
        if let Some(stand) = account.stand {
            return Err(self.refusal(stand, false, account.behind_s(now_s)));
        }
        let volumes = series.iter().map(|part| (part.at_s, part.volume_ml));
        let stand = self.stand_of_all(&account, now_s, volumes);
        let Some(stand) = stand else { return Ok(()) };
        Err(unrecorded(self.refusal(stand, true, account.behind_s(now_s))))
    }

    /// Returns the stand of a pump of which one of a series of volumes would exceed a limit. It tells the volume of the
    /// whole series: the volumes before the one that does not fit are asked for, and not pumped.
    fn stand_of_all(
        &self,
        account: &SafetyAccount,
        now_s: u64,
        series: impl Iterator<Item = (f64, f64)> + Clone,
    ) -> Option<Stand> {
        let stand = account.stand_of_series(&self.safety_limits(), now_s, series.clone())?;
        let (used_ml, all_ml): (f64, f64) = match stand.limit {
            SafetyLimit::Day => (account.day_ml(now_s), series.map(|(_, volume_ml)| volume_ml.abs()).sum()),
            SafetyLimit::Vessel => (account.vessel_ml, series.map(|(_, volume_ml)| volume_ml).sum()),
            SafetyLimit::Ordered => (stand.used_ml, stand.planned_ml),
        };
        let planned_ml = all_ml.max(stand.planned_ml);
        Some(Stand { unix_s: now_s, used_ml, planned_ml, ..self.as_said(stand) })
    }

    /// Returns a stand with the limit as the pump file says it, without the rounding of doses.
    fn as_said(&self, stand: Stand) -> Stand {
        let table = &self.file().safety;
        let allowed_ml = match stand.limit {
            SafetyLimit::Day => table.max_ml_per_day,
            SafetyLimit::Vessel => table.vessel_ml,
            SafetyLimit::Ordered => None,
        };
        Stand { allowed_ml: allowed_ml.unwrap_or(stand.allowed_ml), ..stand }
    }

    /// Returns the error of a pump that stands, while the clock is this far behind the record, in s.
    #[must_use]
    pub fn refusal(&self, stand: Stand, is_new: bool, behind_s: u64) -> DoseError {
        let clock_behind_s = if stand.limit == SafetyLimit::Day { behind_s } else { 0 };
        let (pump, stand) = (self.file().pump.id.clone(), Box::new(stand));
        DoseError::Stands { pump, stand, is_new, is_recorded: true, clock_behind_s }
    }
}

/// Returns a refusal of a stand that is not on record.
fn unrecorded(refused: DoseError) -> DoseError {
    match refused {
        DoseError::Stands { pump, stand, is_new, clock_behind_s, .. } => {
            DoseError::Stands { pump, stand, is_new, is_recorded: false, clock_behind_s }
        }
        refused => refused,
    }
}

impl Session<'_> {
    /// Returns the safety limit that leaves the least to a motion, with what is used of it. `None` without limits.
    pub(in crate::bench) fn nearest_limit(&self, reverse: bool) -> Option<Stand> {
        self.bench.nearest_limit(self.state.as_ref(), self.log.clock.now().unix_s, reverse)
    }

    /// Refuses to move a pump that stands at a safety limit.
    ///
    /// # Errors
    ///
    /// [`DoseError::Stands`] with the limit.
    pub(in crate::bench) fn check_stand(&self) -> Result<(), DoseError> {
        let now_s = self.log.clock.now().unix_s;
        let account = self.bench.safety_account(self.state.as_ref(), now_s);
        let refusal = |stand| self.bench.refusal(stand, false, account.behind_s(now_s));
        account.stand.map_or(Ok(()), |stand| Err(refusal(stand)))
    }

    /// Has the pump stand if a motion of `planned_ml`, negative in reverse, would exceed a safety limit.
    ///
    /// # Errors
    ///
    /// [`DoseError::Stands`] with the limit. The stand is on record.
    pub(in crate::bench) fn keep_safe(&mut self, planned_ml: f64) -> Result<(), DoseError> {
        self.keep_volumes_safe(std::iter::once((0.0, planned_ml)))
    }

    /// Has the pump stand if a safety limit leaves nothing to a run until it is stopped.
    ///
    /// # Errors
    ///
    /// [`DoseError::Stands`] with the limit. The stand is on record.
    pub(in crate::bench) fn keep_run_safe(&mut self, reverse: bool) -> Result<(), DoseError> {
        let now_s = self.log.clock.now().unix_s;
        let Some(stand) = self.bench.used_up(self.nearest_limit(reverse), now_s) else { return Ok(()) };
        let account = self.stands().safety_at(now_s);
        self.record_stand(account, stand);
        Err(self.bench.refusal(stand, true, account.behind_s(now_s)))
    }

    /// Has the pump stand if one of `count` doses of `volume_ml`, one every `every_s` from now on, would exceed a
    /// safety limit. A batch is refused so before its first dose.
    ///
    /// # Errors
    ///
    /// [`DoseError::Stands`] with the limit. The stand is on record. [`DoseError::Unfinished`] if a dose is unfinished.
    pub fn keep_batch_safe(&mut self, volume_ml: f64, count: u64, every_s: f64) -> Result<(), DoseError> {
        self.before_series()?;
        self.keep_volumes_safe((0..count).map(|number| (number as f64 * every_s, volume_ml)))
    }

    /// Has the pump stand if one of a series of volumes would exceed a safety limit, each beside those before it and
    /// those on record. A series is refused so before its first motion.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as for [`Session::keep_batch_safe`].
    pub fn keep_series_safe(&mut self, series: &[TimedVolume]) -> Result<(), DoseError> {
        self.before_series()?;
        self.keep_volumes_safe(series.iter().map(|part| (part.at_s, part.volume_ml)))
    }

    /// Refuses a series on a pump that stands or has an unfinished dose.
    fn before_series(&mut self) -> Result<(), DoseError> {
        self.check_stand()?;
        if self.cut_off.is_some() {
            // A device that still counts tells the steps of a motion that was cut off, before anything is recorded.
            self.connect()?;
        }
        self.finished().map(drop)
    }

    fn keep_volumes_safe(
        &mut self,
        series: impl Iterator<Item = (f64, f64)> + Clone,
    ) -> Result<(), DoseError> {
        self.check_stand()?;
        let now_s = self.log.clock.now().unix_s;
        let account = self.stands().safety_at(now_s);
        let Some(stand) = self.bench.stand_of_all(&account, now_s, series) else {
            self.tell_of_clock(&account, now_s);
            return Ok(());
        };
        self.record_stand(account, stand);
        Err(self.bench.refusal(stand, true, account.behind_s(now_s)))
    }

    /// Has the pump stand after a run until it was stopped that this safety limit ended.
    pub(in crate::bench) fn stand_after_run(&mut self, limit: SafetyLimit) -> Option<Stand> {
        let now_s = self.log.clock.now().unix_s;
        let account = self.stands().safety_at(now_s);
        let stand = account.stand_at(limit, &self.bench.safety_limits(), now_s)?;
        let stand = self.bench.as_said(stand);
        self.record_stand(account, stand);
        Some(stand)
    }

    fn record_stand(&mut self, account: SafetyAccount, stand: Stand) {
        let state = PumpState { safety: Some(account.standing(stand)), ..self.stands() };
        if let Err(error) = self.rest(Why::Stands, state) {
            let text = format!("the stand at the safety limit could not be recorded: {error}");
            self.notes.push(Notice::from(text));
        }
    }

    /// Notes that the clock is behind the record, once a session, if a limit of the day follows it.
    fn tell_of_clock(&mut self, account: &SafetyAccount, now_s: u64) {
        let behind_s = account.behind_s(now_s);
        let is_followed = behind_s > 0 && self.bench.file().safety.max_ml_per_day.is_some();
        if is_followed && !std::mem::replace(&mut self.told_of_clock, true) {
            self.notes.push(Notice::from(clock_behind(behind_s)));
        }
    }
}
