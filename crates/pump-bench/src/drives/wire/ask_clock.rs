//! The clock of the thread that asks for leave, while another thread has the wire.

use std::fmt::Debug;
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Clock of the thread that asks for leave, while another thread has the wire and streams.
///
/// A wire in real time takes the computer's clock. A wire in virtual time has a clock that goes on only while both
/// threads wait, so that a test is the same in every run.
pub trait AskClock: Debug + Send + Sync {
    /// Waits for `time`, or until the other thread has ended. Returns false once it has ended.
    fn wait(&self, time: Duration) -> bool;

    /// Notes that one of the two threads has ended.
    fn end(&self);
}

/// Clock of the computer.
#[derive(Debug, Default)]
pub(in crate::drives) struct SystemAskClock {
    has_ended: Mutex<bool>,
    news: Condvar,
}

impl AskClock for SystemAskClock {
    fn wait(&self, time: Duration) -> bool {
        let has_ended = self.has_ended.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.news.wait_timeout_while(has_ended, time, |has_ended| !*has_ended);
        !*waited.unwrap_or_else(PoisonError::into_inner).0
    }

    fn end(&self) {
        *self.has_ended.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.news.notify_all();
    }
}
