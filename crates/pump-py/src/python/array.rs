//! Arrays of results, on their way to Python without a copy.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// Hands the numbers to Python as a read-only array, without a copy.
pub(crate) fn frozen(py: Python<'_>, numbers: Vec<f64>) -> PyResult<Py<PyArray1<f64>>> {
    let array = PyArray1::from_vec(py, numbers);
    array.try_readwrite()?.make_nonwriteable();
    Ok(array.unbind())
}

/// Hands the numbers to Python as a read-only array of so many rows, without a copy.
pub(crate) fn frozen_rows(py: Python<'_>, numbers: Vec<f64>, rows: usize) -> PyResult<Py<PyArray2<f64>>> {
    let columns = numbers.len() / rows;
    let array = PyArray1::from_vec(py, numbers).reshape([rows, columns])?;
    array.try_readwrite()?.make_nonwriteable();
    Ok(array.unbind())
}
