//! Columns of a run that somebody gives, checked before they become one.

use pump_bench::simulation::COLUMNS;
use pump_model::Shown;
use pyo3::prelude::*;

use crate::python::errors::value;

/// Refuses columns of different lengths, numbers that are not finite, and times that do not rise. The times are the
/// first column.
pub(super) fn check_columns(names: [&str; COLUMNS], columns: &[Vec<f64>; COLUMNS]) -> PyResult<()> {
    let [times, ..] = columns;
    for (name, column) in names.iter().zip(columns) {
        if column.len() != times.len() {
            return Err(value(format_args!(
                "{name} has {} numbers, but {} has {}; allowed: columns of equal length",
                column.len(),
                names[0],
                times.len()
            )));
        }
        if let Some((n, number)) = column.iter().enumerate().find(|(_, number)| !number.is_finite()) {
            return Err(value(format_args!(
                "{name}[{n}] is {}; allowed: a finite number; leave out the samples that have none",
                Shown(*number)
            )));
        }
    }
    let mut pairs = times.iter().zip(times.iter().skip(1)).enumerate();
    if let Some((n, (before_s, time_s))) = pairs.find(|(_, (before_s, time_s))| time_s <= before_s) {
        return Err(value(format_args!(
            "{}[{}] is {}; allowed: more than the time of the sample before, {}; sort the samples by time",
            names[0],
            n + 1,
            Shown(*time_s),
            Shown(*before_s)
        )));
    }
    Ok(())
}
