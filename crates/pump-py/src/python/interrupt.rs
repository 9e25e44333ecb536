//! Ctrl-C during a long solve.

use std::cell::RefCell;
use std::time::{Duration, Instant};

use pyo3::prelude::*;

use super::memory::reserve;

/// Time between two checks for signals. A check takes Python's lock, for which another thread may keep it waiting.
const EVERY: Duration = Duration::from_millis(50);
/// Number of quick results that are computed between two looks at the clock.
const QUICK: usize = 1024;

/// Lets signals interrupt a solve that has released Python's lock.
pub(crate) struct SignalCheck {
    looked: Instant,
}

impl SignalCheck {
    /// Starts the clock; the first check comes a twentieth of a second later.
    pub(crate) fn new() -> Self {
        Self { looked: Instant::now() }
    }

    /// Computes a result for each number, while other Python threads run and signals interrupt.
    pub(crate) fn map<T: Send>(
        py: Python<'_>,
        numbers: &[f64],
        result: impl Fn(f64) -> PyResult<T> + Sync,
    ) -> PyResult<Vec<T>> {
        Self::collect(py, numbers.len(), 1, |n| result(numbers[n]))
    }

    /// Computes `count` results by their numbers, while other Python threads run and signals interrupt.
    pub(crate) fn each<T: Send>(
        py: Python<'_>,
        count: usize,
        result: impl Fn(usize) -> PyResult<T> + Sync,
    ) -> PyResult<Vec<T>> {
        Self::collect(py, count, 1, result)
    }

    /// Computes `count` quick results by their numbers, while other Python threads run and signals interrupt.
    pub(crate) fn quick<T: Send>(
        py: Python<'_>,
        count: usize,
        result: impl Fn(usize) -> PyResult<T> + Sync,
    ) -> PyResult<Vec<T>> {
        Self::collect(py, count, QUICK, result)
    }

    /// Computes `count` results, and looks at the clock before every so many.
    fn collect<T: Send>(
        py: Python<'_>,
        count: usize,
        every: usize,
        result: impl Fn(usize) -> PyResult<T> + Sync,
    ) -> PyResult<Vec<T>> {
        py.detach(|| {
            let mut interrupt = Self::new();
            let mut all = Vec::new();
            reserve(&mut all, count as u64)?;
            for first in (0..count).step_by(every) {
                interrupt.check()?;
                for n in first..count.min(first + every) {
                    all.push(result(n)?);
                }
            }
            Ok(all)
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
