//! Ctrl-C during a long solve.

use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// Time between two checks for signals. A check takes Python's lock, for which another thread may keep it waiting.
const EVERY: Duration = Duration::from_millis(100);

/// Lets signals interrupt a solve that has released Python's lock.
pub(crate) struct Interrupt {
    looked: Instant,
}

impl Interrupt {
    /// Starts the clock; the first check comes a tenth of a second later.
    pub(crate) fn new() -> Self {
        Self { looked: Instant::now() }
    }

    /// Runs the handlers of pending signals now and then. An exception of a handler ends the solve.
    pub(crate) fn check(&mut self) -> PyResult<()> {
        if self.looked.elapsed() < EVERY {
            return Ok(());
        }
        self.looked = Instant::now();
        Python::attach(|py| py.check_signals())
    }
}
