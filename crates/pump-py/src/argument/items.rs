//! Sequences from Python.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyAnyMethods, PyString};

use crate::python::{append, reserve};

/// Items of a Python sequence or iterable, in room that is reserved for them. Too many raise a `MemoryError`.
pub(crate) struct Items<T>(pub(crate) Vec<T>);

impl<'py, T: for<'a> FromPyObject<'a, 'py>> FromPyObject<'_, 'py> for Items<T> {
    type Error = PyErr;

    fn extract(argument: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if argument.is_instance_of::<PyString>() {
            return Err(PyTypeError::new_err("a text is no sequence of items; give a list or a tuple"));
        }
        let mut items = Vec::new();
        reserve(&mut items, argument.len().unwrap_or(0) as u64)?;
        for item in argument.try_iter()? {
            append(&mut items, item?.extract().map_err(Into::into)?)?;
        }
        Ok(Self(items))
    }
}
