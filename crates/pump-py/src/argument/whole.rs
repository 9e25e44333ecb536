//! Whole numbers within a range.

use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;

use crate::python::errors::value;

/// Reads the whole number of the argument `name`, `least` to `most`.
///
/// # Errors
///
/// `ValueError` with the range; `TypeError` for anything that is no whole number.
pub(crate) fn whole<T: TryFrom<i64>>(
    name: &str,
    given: &Bound<'_, PyAny>,
    least: i64,
    most: i64,
) -> PyResult<T> {
    let refused = |number: &str| value(format_args!("{name} is {number}; allowed: {least} to {most}"));
    match given.extract::<i64>() {
        Ok(number) => Some(number)
            .filter(|number| (least..=most).contains(number))
            .and_then(|number| T::try_from(number).ok())
            .ok_or_else(|| refused(&number.to_string())),
        Err(error) if error.is_instance_of::<PyOverflowError>(given.py()) => {
            Err(refused("a whole number beyond 64 bits"))
        }
        Err(_) => Err(PyTypeError::new_err(format!(
            "{name} must be a whole number, not {}",
            given.get_type().name()?
        ))),
    }
}
