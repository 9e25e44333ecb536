//! The pumps that the guard keeps still.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use super::placing::Refusal;
use crate::order::{Order, Task};

/// Reason why a pump is kept still.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Stillness {
    /// Input that is not well, what it says, and what to do.
    pub(crate) reason: String,
    /// True until the stand is on the pump's record. Nothing else is done to the pump meanwhile.
    pub(crate) is_pending: bool,
}

/// Pumps that are kept still, by their names.
#[derive(Debug, Default)]
pub(super) struct Still(Mutex<BTreeMap<String, Stillness>>);

impl Still {
    /// Keeps these pumps still from now on, and no others.
    pub(super) fn set(&self, pumps: BTreeMap<String, Stillness>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = pumps;
    }

    /// Refuses an order that would move a pump that is kept still. A stand is never refused. An order of several pumps
    /// is refused while a stand is not on record yet: afterwards the record of each pump refuses by itself.
    ///
    /// # Errors
    ///
    /// [`Refusal::Guarded`] with the reason.
    pub(super) fn check(&self, order: &Order) -> Result<(), Refusal> {
        if matches!(order.task, Task::Stand { .. }) {
            return Ok(());
        }
        let still = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let stands = match still.get(&order.pump) {
            Some(stands) => Some((&order.pump, stands)).filter(|_| stands.is_pending || order.task.moves()),
            None if order.pump.is_empty() => still.iter().find(|(_, stands)| stands.is_pending),
            None => None,
        };
        stands.map_or(Ok(()), |(pump, stands)| {
            Err(Refusal::Guarded { pump: pump.clone(), reason: stands.reason.clone() })
        })
    }
}
