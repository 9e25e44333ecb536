//! The state from which a dry run plans.

use std::path::PathBuf;

use pump_ctl::plan::Phase;
use pump_model::units::{TURN_RAD, wrap};

use super::Bench;
use crate::dosing::DoseError;
use crate::record::{PhaseSource, PumpState};

/// Angles of a pitch at which a dry run that leaves the record out plans, until one is not refused.
const ANGLES: u8 = 6;

impl Bench {
    /// Returns the bench whose dry runs leave the pump's record out, or not. They plan for a pump at rest with a new
    /// tube, and with nothing counted by a safety limit. Its rotor may stand anywhere: they refuse what is refused at
    /// each of several angles of a pitch. The calibration counts, the confirmation of the pump, and the settings of its
    /// board. So they refuse what can never be made, whatever the pump waits for now, and a pump that nobody has
    /// confirmed.
    #[must_use]
    pub fn planning_afresh(self, afresh: bool) -> Self {
        Self { plans_afresh: afresh, ..self }
    }

    /// Returns true if dry runs leave the pump's record out.
    pub(in crate::bench) fn plans_afresh(&self) -> bool {
        self.plans_afresh
    }

    /// Returns the places on record that a dry run reads which leaves the rest of the record out: its folder of
    /// calibrations, and the settings of its board. They may not be there.
    pub fn read_afresh(&self) -> Vec<PathBuf> {
        let settings = self.opening().settings_record.clone();
        [self.calibrations().folder().to_owned()].into_iter().chain(settings).collect()
    }

    /// Returns the state that dry runs take for that on record. `None` if nothing is on record.
    pub(in crate::bench) fn state_to_plan(&self) -> Result<Option<PumpState>, DoseError> {
        if !self.plans_afresh {
            return Ok(self.story()?.state);
        }
        let recorded = self.story()?.state;
        let confirmed_pump = recorded.and_then(|state| state.confirmed_pump);
        let turned_by = recorded.and_then(|state| state.turned_by);
        let fresh = PumpState::fresh(Phase::known(0.0), PhaseSource::Home);
        Ok(Some(PumpState { confirmed_pump, turned_by, ..fresh.as_recorded(self.model().pitch_rad()) }))
    }

    /// Plans as if `state` were on record. Where the record is left out and that is refused, other angles of a pitch
    /// are tried too, as nobody knows at which one the rotor stands on the night. Returns the first refusal if each one
    /// is refused.
    pub(in crate::bench) fn plan_at_some_angle<T, E>(
        &self,
        state: Option<PumpState>,
        plan: impl Fn(Option<PumpState>) -> Result<T, E>,
    ) -> Result<T, E> {
        let planned = plan(state);
        let Some(state) = state.filter(|_| self.plans_afresh && planned.is_err()) else { return planned };
        let apart_rad = self.model().pitch_rad() / f64::from(ANGLES);
        let at = |number: u8| {
            let angle_rad = wrap(state.angle_rad + f64::from(number) * apart_rad, TURN_RAD);
            Some(PumpState { angle_rad, ..state })
        };
        (1..ANGLES).find_map(|number| plan(at(number)).ok()).map_or(planned, Ok)
    }

    /// Returns the recorded state from which a dose can be planned while nothing moves. Without the record, a pump that
    /// nobody has confirmed is refused as its motion will be.
    pub(in crate::bench) fn state_to_plan_from(&self) -> Result<Option<PumpState>, DoseError> {
        let state = self.state_to_plan()?.map(|state| self.as_told(state));
        if self.plans_afresh {
            self.check_confirmed(state.as_ref())?;
        }
        if state.is_some_and(|state| state.unfinished.is_some())
            && let Some(holder) = self.folder().holder()
        {
            return Err(self.folder().busy(holder).into());
        }
        Ok(state)
    }
}
