//! Arguments that must be objects of this package, and what an error says of anything else.

use pyo3::PyTypeInfo;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyType};

use crate::python::readable;

/// Reads the object of the argument `name`. `kind` is the name of its class, `ways` tells how to make one.
///
/// # Errors
///
/// `TypeError` for anything else, with the ways to one.
pub(crate) fn object<T: PyTypeInfo>(
    name: &str,
    kind: &str,
    ways: &str,
    given: &Bound<'_, PyAny>,
) -> PyResult<Py<T>> {
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
