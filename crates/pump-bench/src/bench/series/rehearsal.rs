//! A rehearsal: a batch of doses that moves nothing.

use crate::bench::bench::Bench;
use crate::bench::session::Session;
use crate::dosing::{DoseError, DoseRequest, Prepared};
use crate::record::PumpState;

/// Session that moves and records nothing. Each dose is planned from where the one before would leave the
/// pump.
#[derive(Debug, Clone)]
pub struct Rehearsal<'a> {
    bench: &'a Bench,
    state: Option<PumpState>,
}

impl Session<'_> {
    /// Starts a rehearsal from the state of this session, in which the device was met.
    ///
    /// # Errors
    ///
    /// [`DoseError::Connection`] if the device cannot be used. [`DoseError::Journal`] if its state cannot be
    /// recorded.
    pub fn rehearsal(&mut self) -> Result<Rehearsal<'_>, DoseError> {
        self.connect()?;
        Ok(Rehearsal { bench: self.bench, state: self.state })
    }
}

impl<'a> Rehearsal<'a> {
    /// Starts a rehearsal from the recorded state.
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] if the journal cannot be read. [`DoseError::Folder`] if another process moves the
    /// pump, because nobody knows yet where it will stop.
    pub fn new(bench: &'a Bench) -> Result<Self, DoseError> {
        Ok(Self { bench, state: bench.state_to_plan_from()? })
    }

    /// Plans a dose and goes on as if it had been delivered.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if the dose cannot be planned, or a dose is unfinished.
    pub fn prepare(&mut self, request: DoseRequest) -> Result<Prepared, DoseError> {
        let prepared = self.bench.rehearse(self.state, request)?;
        self.state = Some(self.bench.after_motion(self.state, &prepared, request.purpose));
        Ok(prepared)
    }
}
