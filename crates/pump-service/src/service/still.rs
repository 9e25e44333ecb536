//! The pumps that the guard keeps still.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use super::placing::Refusal;
use crate::order::Order;

/// Reason why a pump is kept still.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Stillness {
    /// Input that is not well, what it says, and what to do.
    pub(crate) reason: String,
    /// Input that is not well now, and what it says; `None` once all are well.
    pub(crate) fault: Option<String>,
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

    /// Returns true if the pump of this name is kept still.
    pub(super) fn has(&self, pump: &str) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).contains_key(pump)
    }

    /// Refuses an order that would move a pump that is kept still, and the clearing of one whose input is not well. A
    /// stand is never refused. An order of several pumps is refused while a stand is not on record yet: afterwards the
    /// record of each pump refuses by itself.
    ///
    /// # Errors
    ///
    /// [`Refusal::Guarded`] or [`Refusal::NotWell`] with the reason.
    pub(super) fn check(&self, order: &Order) -> Result<(), Refusal> {
        if order.task.stands() {
            return Ok(());
        }
        let still = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let fault = still.get(&order.pump).and_then(|stands| stands.fault.as_ref());
        if let Some(fault) = fault.filter(|_| order.task.clears()) {
            return Err(Refusal::NotWell { pump: order.pump.clone(), fault: fault.clone() });
        }
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
