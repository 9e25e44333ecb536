//! Names that have changed.

use pyo3::prelude::*;

/// Warns the caller of a former name, and tells the name to use.
pub(crate) fn renamed(py: Python<'_>, former: &str, now: &str) -> PyResult<()> {
    py.import("pumpmodel._results.renamed")?.call_method1("renamed", (former, now, 1))?;
    Ok(())
}
