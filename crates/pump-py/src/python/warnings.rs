//! Python warnings.

use std::ffi::CString;

use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;

/// Warns of each message, at the line that called into `pumpmodel`.
///
/// # Errors
///
/// The exception of a warning that a filter turned into one.
pub(crate) fn warn(py: Python<'_>, messages: &[String]) -> PyResult<()> {
    for message in messages {
        let message = CString::new(message.replace('\0', "\\0"))?;
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, depth(py)?)?;
    }
    Ok(())
}

/// Returns the number of Python frames from the one that runs to the one that called into `pumpmodel`.
fn depth(py: Python<'_>) -> PyResult<i32> {
    let mut frame = py.import("sys")?.call_method1("_getframe", (0,))?;
    let mut depth = 1;
    while !frame.is_none() {
        let name: Option<String> =
            frame.getattr("f_globals")?.call_method1("get", ("__name__",))?.extract()?;
        if !name.is_some_and(|name| name == "pumpmodel" || name.starts_with("pumpmodel.")) {
            break;
        }
        frame = frame.getattr("f_back")?;
        depth += 1;
    }
    Ok(depth)
}
