//! The word of a person to a pump that stands.

use super::reason::checked;
use crate::bench::session::Session;
use crate::dosing::DoseError;
use crate::record::{PumpState, Why};
use crate::safety::Stand;

/// Stand that a person has cleared.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Cleared {
    /// Stand that was cleared.
    pub stand: Stand,
    /// Volume of the last 24 hours that counts no more, in mL; 0 unless the limit of a day was reached.
    pub forgotten_ml: f64,
    /// Volume that the vessel has received since it was emptied, in mL. It still counts.
    pub vessel_ml: f64,
}

impl Session<'_> {
    /// Clears the stand of the pump. The volumes of the last 24 hours count no more if it stood at their limit. The
    /// vessel holds what it holds until [`Session::vessel_emptied`].
    ///
    /// # Errors
    ///
    /// [`DoseError::NotCleared`] if the pump does not stand, or for a reason that is empty or longer than 1000 bytes.
    /// [`DoseError::Journal`] if it cannot be recorded.
    pub fn clear_safety(&mut self, reason: &str) -> Result<Cleared, DoseError> {
        let refused = |why| DoseError::NotCleared { pump: self.bench.file().pump.id.clone(), why };
        let now_s = self.log.clock.now().unix_s;
        let account = self.stands().safety_at(now_s);
        let stand = account.stand.ok_or_else(|| refused("it does not stand"))?;
        let reason = checked(reason, "the reason is empty; say why it may go on").map_err(refused)?;
        let cleared = account.cleared(now_s);
        let forgotten_ml = account.day_ml(now_s) - cleared.day_ml(now_s);
        let vessel_ml = account.vessel_ml;
        let state = PumpState { safety: Some(cleared), ..self.stands() };
        self.rest_because(Why::Cleared, state, Some(reason.to_owned()))?;
        Ok(Cleared { stand, forgotten_ml, vessel_ml })
    }

    /// Records that the receiving vessel is empty. Returns the volume that it had received, in mL. A pump that stands
    /// at a safety limit stands on.
    ///
    /// # Errors
    ///
    /// [`DoseError::Connection`] if the user asked to stop meanwhile. [`DoseError::Journal`] if it cannot be recorded.
    pub fn vessel_emptied(&mut self) -> Result<f64, DoseError> {
        let state = self.met_after_cut_off()?;
        let account = state.safety_at(self.log.clock.now().unix_s);
        self.rest(Why::Emptied, PumpState { safety: Some(account.emptied()), ..state })?;
        Ok(account.vessel_ml)
    }
}
