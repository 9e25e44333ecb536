//! The catalogue of bought heads behind `pumpmodel.heads`.

use pump_bench::heads::{heads_json, heads_matching};
use pyo3::prelude::*;

/// Returns the heads that match all words, as JSON.
#[pyfunction]
pub(crate) fn _heads(words: Vec<String>) -> String {
    heads_json(&heads_matching(&words))
}
