//! The word of a person to a pump that stands at a safety limit.

use crate::bench::session::Session;
use crate::dosing::DoseError;
use crate::record::{PumpState, Why};
use crate::safety::Stand;

/// Longest reason that is kept, in bytes.
const MOST_REASON: usize = 1000;

/// Stand at a safety limit that a person has cleared.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Cleared {
    /// Stand that was cleared.
    pub stand: Stand,
    /// Volume of the last 24 hours that counts no more, in mL.
    pub forgotten_ml: f64,
    /// Volume that the vessel has received since it was emptied, in mL. It still counts.
    pub vessel_ml: f64,
}

impl Session<'_> {
    /// Clears the stand of the pump at a safety limit. The volumes of the last 24 hours count no more. The vessel holds
    /// what it holds until [`Session::vessel_emptied`].
    ///
    /// # Errors
    ///
    /// [`DoseError::NotCleared`] if the pump does not stand, or for a reason that is empty or longer than 1000 bytes.
    /// [`DoseError::Journal`] if it cannot be recorded.
    pub fn clear_safety(&mut self, reason: &str) -> Result<Cleared, DoseError> {
        let refused = |why| DoseError::NotCleared { pump: self.bench.file().pump.id.clone(), why };
        let reason = reason.trim();
        let now_s = self.log.clock.now().unix_s;
        let account = self.stands().safety_at(now_s);
        let stand = account.stand.ok_or_else(|| refused("it does not stand at a safety limit"))?;
        if reason.is_empty() {
            return Err(refused("the reason is empty; say why it may go on"));
        }
        if reason.len() > MOST_REASON {
            return Err(refused("the reason is longer than 1000 bytes"));
        }
        let (forgotten_ml, vessel_ml) = (account.day_ml(now_s), account.vessel_ml);
        let state = PumpState { safety: Some(account.cleared(now_s)), ..self.stands() };
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
        // A device that still knows its count tells the steps of a motion that was cut off. Otherwise the recorded
        // bounds stay, and the count starts anew when the device is met again.
        let unasked = match if self.cut_off.is_some() { self.connect() } else { Ok(()) } {
            Err(error) if error.is_stop() => return Err(error),
            asked => asked.is_err(),
        };
        let state = self.stands();
        let account = state.safety_at(self.log.clock.now().unix_s);
        let count = state.count.filter(|_| !unasked);
        self.rest(Why::Emptied, PumpState { safety: Some(account.emptied()), count, ..state })?;
        Ok(account.vessel_ml)
    }
}
