//! Arrays of results, on their way to Python without a copy.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

/// Hands the numbers to Python as a read-only array, without a copy.
pub(crate) fn frozen(py: Python<'_>, numbers: Vec<f64>) -> PyResult<Py<PyArray1<f64>>> {
    let array = PyArray1::from_vec(py, numbers);
    array.try_readwrite()?.make_nonwriteable();
    Ok(array.unbind())
}
