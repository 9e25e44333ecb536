//! The order to a pump to stand.

use super::reason::checked;
use crate::bench::session::Session;
use crate::dosing::DoseError;
use crate::record::{PumpState, Why};
use crate::safety::Stand;

impl Session<'_> {
    /// Puts the pump to stand: every motion is refused with [`DoseError::Stands`], over restarts, until a person clears
    /// it with [`Session::clear_safety`]. A pump that stands already stands by this order and for this reason
    /// afterwards; its safety limits go on to count.
    ///
    /// ```
    /// use pump_bench::{Bench, DoseRequest, built_in};
    ///
    /// let state = tempfile::tempdir()?;
    /// let bench = Bench::new(built_in("three-roller").unwrap(), None, state.path())?;
    /// let mut session = bench.session()?;
    /// session.stand("there is water under the rack")?;
    /// assert!(session.prepare(DoseRequest::dose(1.0)).is_err());
    /// session.clear_safety("the hose is tight again")?;
    /// assert!(session.prepare(DoseRequest::dose(1.0)).is_ok());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`DoseError::NotPutToStand`] for a reason that is empty, longer than 1000 bytes or has control characters.
    /// [`DoseError::Connection`] if the user asked to stop meanwhile. [`DoseError::Journal`] if it cannot be recorded.
    pub fn stand(&mut self, reason: &str) -> Result<Stand, DoseError> {
        let refused = |why| DoseError::NotPutToStand { pump: self.bench.file().pump.id.clone(), why };
        let reason = checked(reason, "the reason is empty; say why it stands").map_err(refused)?;
        // Every refusal shows the reason, and it shall not rewrite a terminal.
        if reason.chars().any(char::is_control) {
            return Err(refused("the reason has control characters; write it in one line"));
        }
        let state = self.met_after_cut_off()?;
        let now_s = self.log.clock.now().unix_s;
        let stand = Stand::ordered(reason, now_s);
        let account = state.safety_at(now_s).standing(stand);
        let state = PumpState { safety: Some(account), ..state };
        self.rest_because(Why::Stands, state, Some(reason.to_owned()))?;
        Ok(stand)
    }

    /// Returns the state of the pump for a word that does not move it. A device that still knows its count tells the
    /// steps of a motion that was cut off. Otherwise the recorded bounds stay, and the count starts anew when the
    /// device is met again.
    ///
    /// # Errors
    ///
    /// [`DoseError::Connection`] if the user asked to stop meanwhile.
    pub(super) fn met_after_cut_off(&mut self) -> Result<PumpState, DoseError> {
        let unasked = match if self.cut_off.is_some() { self.connect() } else { Ok(()) } {
            Err(error) if error.is_stop() => return Err(error),
            asked => asked.is_err(),
        };
        let state = self.stands();
        Ok(PumpState { count: state.count.filter(|_| !unasked), ..state })
    }
}
