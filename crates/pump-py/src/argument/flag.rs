//! Arguments that are True or False.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use super::speed::Argument;

/// Reads whether the argument `name` is True. An argument that is left out is False.
///
/// # Errors
///
/// `TypeError` for anything that is neither Python's nor NumPy's True or False.
pub(crate) fn flag(name: &str, given: Argument<'_, '_>) -> PyResult<bool> {
    let Some(given) = given else { return Ok(false) };
    let kind = given.get_type().name()?;
    given.extract().map_err(|_| PyTypeError::new_err(format!("{name} must be True or False, not {kind}")))
}
