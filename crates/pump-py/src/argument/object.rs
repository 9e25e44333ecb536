//! Arguments that must be objects of this package, and what an error says of anything else.

use pyo3::PyTypeInfo;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyType};

use super::speed::Argument;
use crate::line::Line;
use crate::pump::Pump;
use crate::python::readable;

/// Ways to a line.
const LINES: &str = "hose.line(fluid, reservoir_kpa=..., flow_ml_s=...) makes the line of a hose, pm.Line(...) one of R, C and L";
/// Ways to a pump.
const PUMPS: &str = "pm.Pump.three_roller() makes one, pm.Pump.named(...) another of its file or its name";

/// Reads the line of the argument `name` if it is given.
///
/// # Errors
///
/// `TypeError` for anything else, with the ways to a line.
pub(crate) fn optional_line(name: &str, given: Argument<'_, '_>) -> PyResult<Option<Py<Line>>> {
    given.map(|given| object(name, "Line", LINES, given)).transpose()
}

/// Reads the pump of the argument `pump`.
///
/// # Errors
///
/// `TypeError` for anything else, with the ways to a pump.
pub(crate) fn pump_given(given: &Bound<'_, PyAny>) -> PyResult<Py<Pump>> {
    object("pump", "Pump", PUMPS, given)
}

fn object<T: PyTypeInfo>(name: &str, kind: &str, ways: &str, given: &Bound<'_, PyAny>) -> PyResult<Py<T>> {
    match given.cast::<T>() {
        Ok(object) => Ok(object.clone().unbind()),
        Err(_) => {
            Err(PyTypeError::new_err(format!("{name} must be a {kind}, not {}; {ways}", told_of(given)?)))
        }
    }
}

/// Returns the words for what an argument is: a class, a text, or an object of a type.
///
/// # Errors
///
/// The exception of a type that has no name.
pub(crate) fn told_of(given: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(class) = given.cast::<PyType>() {
        return Ok(format!("the class {} itself", class.name()?));
    }
    if let Ok(text) = given.cast::<PyString>() {
        return Ok(readable::readable(&format!("the text '{text}'")));
    }
    Ok(given.get_type().name()?.to_string())
}
