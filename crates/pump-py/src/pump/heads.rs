//! The catalogue of bought heads behind `pumpmodel.heads`.

use pump_bench::heads::{heads_json, heads_matching};
use pyo3::prelude::*;

use crate::python::spare::refill;

/// Returns the heads that match all words, as JSON.
#[pyfunction]
pub(crate) fn _heads(words: Vec<String>) -> PyResult<String> {
    refill()?;
    Ok(heads_json(&heads_matching(&words)))
}
