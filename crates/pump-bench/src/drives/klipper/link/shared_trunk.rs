//! The trunk that several threads share, each in its turn.

use std::ops::{Deref, DerefMut};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::trunk::Trunk;
use crate::drives::wire::Wire;

/// Numbers of the threads that wait: a mutex alone may let one thread in again and again.
#[derive(Debug, Default)]
struct Turns {
    next: u64,
    served: u64,
}

/// Trunk to a board, which the links of several motors share.
#[derive(Debug)]
pub(in crate::drives::klipper) struct SharedTrunk {
    turns: Mutex<Turns>,
    /// Told whenever a thread is done.
    news: Condvar,
    trunk: Mutex<Trunk>,
}

impl SharedTrunk {
    /// Makes the trunk over a wire.
    pub(in crate::drives::klipper) fn new(wire: Box<dyn Wire>) -> Self {
        Self { turns: Mutex::default(), news: Condvar::new(), trunk: Mutex::new(Trunk::new(wire)) }
    }

    /// Returns true once the wire has failed.
    pub(in crate::drives::klipper) fn is_gone(&self) -> bool {
        self.lock().is_gone
    }

    /// Takes the trunk when it is this thread's turn.
    pub(super) fn lock(&self) -> TrunkGuard<'_> {
        let mut turns = self.turns.lock().unwrap_or_else(PoisonError::into_inner);
        let mine = turns.next;
        turns.next += 1;
        let turns = self.news.wait_while(turns, |turns| turns.served != mine);
        drop(turns.unwrap_or_else(PoisonError::into_inner));
        TrunkGuard { trunk: self.trunk.lock().unwrap_or_else(PoisonError::into_inner), shared: self }
    }
}

/// Trunk while a thread has it.
#[derive(Debug)]
pub(super) struct TrunkGuard<'a> {
    trunk: MutexGuard<'a, Trunk>,
    shared: &'a SharedTrunk,
}

impl Deref for TrunkGuard<'_> {
    type Target = Trunk;

    fn deref(&self) -> &Trunk {
        &self.trunk
    }
}

impl DerefMut for TrunkGuard<'_> {
    fn deref_mut(&mut self) -> &mut Trunk {
        &mut self.trunk
    }
}

impl Drop for TrunkGuard<'_> {
    fn drop(&mut self) {
        self.shared.turns.lock().unwrap_or_else(PoisonError::into_inner).served += 1;
        self.shared.news.notify_all();
    }
}
