//! The state from which a dry run plans.

use pump_ctl::plan::Phase;

use super::Bench;
use crate::dosing::DoseError;
use crate::record::{PhaseSource, PumpState};

impl Bench {
    /// Returns the bench whose dry runs leave the pump's record out, or not. They plan for a pump at rest whose rotor
    /// stands at 0 deg, with a new tube, and with nothing counted by a safety limit. Its calibration counts. So they
    /// refuse what can never be made, whatever the pump waits for now.
    #[must_use]
    pub fn planning_afresh(self, afresh: bool) -> Self {
        Self { plans_afresh: afresh, ..self }
    }

    /// Returns true if dry runs leave the pump's record out.
    pub(in crate::bench) fn plans_afresh(&self) -> bool {
        self.plans_afresh
    }

    /// Returns the state that dry runs take for that on record. `None` if nothing is on record.
    pub(in crate::bench) fn state_to_plan(&self) -> Result<Option<PumpState>, DoseError> {
        if !self.plans_afresh {
            return Ok(self.story()?.state);
        }
        let fresh = PumpState::fresh(Phase::known(0.0), PhaseSource::Home);
        Ok(Some(fresh.as_recorded(self.model().pitch_rad())))
    }

    /// Returns the recorded state from which a dose can be planned while nothing moves.
    pub(in crate::bench) fn state_to_plan_from(&self) -> Result<Option<PumpState>, DoseError> {
        let state = self.state_to_plan()?;
        if state.is_some_and(|state| state.unfinished.is_some())
            && let Some(holder) = self.folder().holder()
        {
            return Err(self.folder().busy(holder).into());
        }
        Ok(state)
    }
}
