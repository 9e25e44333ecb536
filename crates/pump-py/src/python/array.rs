//! Arrays of results: their memory, and their way to Python without a copy.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

/// Reserves room for `count` numbers. Too many raise a `MemoryError` where an allocation would abort.
pub(crate) fn reserve(column: &mut Vec<f64>, count: u64) -> PyResult<()> {
    usize::try_from(count)
        .ok()
        .and_then(|count| column.try_reserve_exact(count).ok())
        .ok_or_else(|| PyMemoryError::new_err(format!("no memory for {count} samples")))
}

/// Hands the numbers to Python as a read-only array, without a copy.
pub(crate) fn frozen(py: Python<'_>, numbers: Vec<f64>) -> PyResult<Py<PyArray1<f64>>> {
    let array = PyArray1::from_vec(py, numbers);
    array.try_readwrite()?.make_nonwriteable();
    Ok(array.unbind())
}
