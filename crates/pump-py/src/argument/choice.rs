//! Words of a fixed set, such as "inlet" or "outlet".

use std::fmt::Display;

use pump_ctl::plan::{Finish, Ramps};
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

/// Returns the one of the library's choices that was given for `name`, by the library's own words.
pub(crate) fn word<T: Copy + Display>(name: &str, given: &str, all: &[T]) -> PyResult<T> {
    let words: Vec<String> = all.iter().map(T::to_string).collect();
    let named: Vec<(&str, T)> = words.iter().map(String::as_str).zip(all.iter().copied()).collect();
    choice(name, given, &named)
}

/// Reads where in a pitch a dose may end.
pub(crate) fn finish_named(name: &str) -> PyResult<Finish> {
    name.parse().map_err(value)
}

/// Reads the ramps in which a dose starts and stops.
pub(crate) fn ramps_named(name: &str) -> PyResult<Ramps> {
    name.parse().map_err(value)
}
