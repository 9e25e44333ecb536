//! Ctrl-C during a long solve.

use std::cell::RefCell;
use std::time::{Duration, Instant};

use pyo3::prelude::*;

use super::memory::try_collected;

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
            try_collected(numbers.iter().map(result))
        })
    }

    /// Computes what asks now and then whether to go on, while other Python threads run. A handler's exception answers
    /// no, and is raised.
    pub(crate) fn during<T: Send>(
        py: Python<'_>,
        computed: impl FnOnce(&dyn Fn() -> bool) -> T + Send,
    ) -> PyResult<T> {
        py.detach(|| {
            let (interrupt, raised) = (RefCell::new(Self::new()), RefCell::new(None));
            let result = computed(&|| match interrupt.borrow_mut().check() {
                Ok(()) => true,
                Err(error) => {
                    raised.replace(Some(error));
                    false
                }
            });
            raised.into_inner().map_or(Ok(result), Err)
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
