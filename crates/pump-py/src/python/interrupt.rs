//! Ctrl-C during a long solve.

use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// Time between two checks for signals. A check takes Python's lock, for which another thread may keep it waiting.
const EVERY: Duration = Duration::from_millis(100);

/// Lets signals interrupt a solve that has released Python's lock.
pub(crate) struct SignalCheck {
    looked: Instant,
}

impl SignalCheck {
    /// Starts the clock; the first check comes a tenth of a second later.
    pub(crate) fn new() -> Self {
        Self { looked: Instant::now() }
    }

    /// Computes a result for each number, while other Python threads run and signals interrupt.
    pub(crate) fn map<T: Send>(
        py: Python<'_>,
        numbers: &[f64],
        result: impl Fn(f64) -> PyResult<T> + Sync,
    ) -> PyResult<Vec<T>> {
        py.detach(|| {
            let mut interrupt = Self::new();
            let result = |number: &f64| interrupt.check().and_then(|()| result(*number));
            numbers.iter().map(result).collect()
        })
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
