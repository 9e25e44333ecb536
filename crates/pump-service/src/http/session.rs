//! Logins of people at the page.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::order::random_hex;

/// Name of the cookie.
pub(super) const SESSION_COOKIE: &str = "dose-session";

/// Most logins at a time: a further one ends the oldest.
const MOST: usize = 200;

/// Time for which a login holds.
pub(super) const HOLDS: Duration = Duration::from_secs(30 * 24 * 3600);

/// The logins that hold. The end of the service ends them all.
#[derive(Debug, Default)]
pub(super) struct Sessions(Mutex<VecDeque<(String, Instant)>>);

impl Sessions {
    /// Begins a login. Returns the value of its cookie.
    pub(super) fn begin(&self) -> Result<String, getrandom::Error> {
        let value = random_hex::<32>()?;
        let mut sessions = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if sessions.len() == MOST {
            sessions.pop_front();
        }
        sessions.push_back((value.clone(), Instant::now()));
        Ok(value)
    }

    /// Returns true if the login of this cookie holds.
    pub(super) fn has(&self, value: &str) -> bool {
        let mut sessions = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        sessions.retain(|(_, begun)| begun.elapsed() < HOLDS);
        sessions.iter().any(|(session, _)| session == value)
    }

    /// Ends every login.
    pub(super) fn end_all(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }
}
