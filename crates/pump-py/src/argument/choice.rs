//! Words of a fixed set, such as "inlet" or "outlet".

use pump_ctl::plan::Finish;
use pyo3::prelude::*;

use crate::python::errors::value;

/// Returns the value of the word that was given for `name`. Any other word is refused with the list of those allowed.
pub(crate) fn choice<T: Copy>(name: &str, given: &str, allowed: &[(&str, T)]) -> PyResult<T> {
    if let Some((_, chosen)) = allowed.iter().find(|(word, _)| *word == given) {
        return Ok(*chosen);
    }
    let words: Vec<_> = allowed.iter().map(|(word, _)| format!("'{word}'")).collect();
    Err(value(format_args!("{name} is '{given}'; allowed: {}", words.join(", "))))
}

/// Reads where in a pitch a dose may end.
pub(crate) fn finish_named(name: &str) -> PyResult<Finish> {
    name.parse().map_err(value)
}
