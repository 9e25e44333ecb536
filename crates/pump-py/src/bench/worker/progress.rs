//! The function that hears of a motion's progress, checked before anything moves.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// Refuses a `progress` that cannot be called with `count` arguments.
///
/// # Errors
///
/// `TypeError` with the reason. A function that does not tell its arguments, as some of C, is taken.
pub(in crate::bench) fn check_progress(progress: Option<&Bound<'_, PyAny>>, count: usize) -> PyResult<()> {
    let Some(progress) = progress else { return Ok(()) };
    let py = progress.py();
    let takes = match count {
        2 => "the steps made and the steps planned",
        _ => "the pump, the number of its step, the motor steps made and those planned",
    };
    if !progress.is_callable() {
        return Err(PyTypeError::new_err(format!(
            "progress must be a function of {takes}, not {}; nothing moved",
            progress.get_type().name()?
        )));
    }
    let signature = match py.import("inspect")?.call_method1("signature", (progress,)) {
        Ok(signature) => signature,
        Err(error) if error.is_instance_of::<PyValueError>(py) => return Ok(()),
        Err(error) => return Err(error),
    };
    match signature.call_method1("bind", PyTuple::new(py, vec![0; count])?) {
        Err(error) if error.is_instance_of::<PyTypeError>(py) => Err(PyTypeError::new_err(format!(
            "progress is called with {count} arguments, {takes}, but takes {signature} ({}); nothing moved",
            error.value(py)
        ))),
        bound => bound.map(|_| ()),
    }
}
