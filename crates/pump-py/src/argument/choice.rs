//! Words of a fixed set, such as "inlet" or "outlet".

use std::fmt::Display;

use pump_ctl::plan::{Finish, Ramps};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyString;

use super::object::told_of;
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

/// Returns the text of the argument `name`.
///
/// # Errors
///
/// `TypeError` for anything else.
pub(crate) fn told<'a>(name: &str, given: &'a Bound<'_, PyAny>) -> PyResult<&'a str> {
    match given.cast::<PyString>() {
        Ok(text) => text.to_str(),
        Err(_) => Err(PyTypeError::new_err(format!("{name} must be a text, not {}", told_of(given)?))),
    }
}

/// Reads where in a pitch a dose may end.
pub(crate) fn finish_named(name: &str) -> PyResult<Finish> {
    word("finish", name, &Finish::ALL)
}

/// Reads the ramps in which a dose starts and stops.
pub(crate) fn ramps_named(name: &str) -> PyResult<Ramps> {
    word("ramps", name, &Ramps::ALL)
}
