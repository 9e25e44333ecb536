//! The schedule of a batch.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use pump_bench::dosing::{Missed, Schedule as DoseSchedule, ScheduleAction};
use pyo3::prelude::*;

use crate::argument::{Argument, optional, whole, word};
use crate::python::errors::value;

/// Schedule of a batch: the time at which each dose is due.
#[pyclass(frozen, name = "_Schedule", module = "pumpmodel._pumpmodel")]
pub(crate) struct Schedule(Mutex<DoseSchedule>);

#[pymethods]
impl Schedule {
    #[new]
    fn new(count: &Bound<'_, PyAny>, every_s: Argument<'_, '_>, missed: &str) -> PyResult<Self> {
        let every_s = optional("every_s", every_s)?;
        let count = whole("count", count, 1, 1_000_000)?;
        let missed = word("missed", missed, Missed::ALL)?;
        Ok(Self(Mutex::new(DoseSchedule::new(count, every_s, missed).map_err(value)?)))
    }

    /// Returns the next action, `elapsed_s` after the batch's start.
    ///
    /// The action is "wait" with the time to wait for, s; "dose" or "skip" with the dose's number; or "done".
    fn next(&self, elapsed_s: f64) -> PyResult<(&'static str, f64)> {
        let elapsed = Duration::try_from_secs_f64(elapsed_s).map_err(value)?;
        let mut schedule = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(match schedule.next(elapsed) {
            ScheduleAction::Wait(until) => ("wait", until.as_secs_f64()),
            ScheduleAction::Dose(number) => ("dose", number as f64),
            ScheduleAction::Skip(number) => ("skip", number as f64),
            ScheduleAction::Done => ("done", 0.0),
        })
    }
}
