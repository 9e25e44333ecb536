//! Quantities as text with their unit.

use std::fmt::Display;

use pump_bench::units;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::python::errors::value;

/// Returns the text of the quantity `name`. A bare number has no unit and is a `TypeError`.
pub(crate) fn text<'a>(name: &str, example: &str, argument: &'a Bound<'_, PyAny>) -> PyResult<&'a str> {
    match argument.cast::<PyString>() {
        Ok(text) => text.to_str(),
        Err(_) => Err(PyTypeError::new_err(format!(
            "{name} must be text with its unit, as \"{example}\", not {}",
            argument.get_type().name()?
        ))),
    }
}

/// Returns the quantity that `read` finds in the text of the argument `name`. A refusal names the argument.
pub(crate) fn quantity<T, E: Display>(
    name: &str,
    example: &str,
    argument: &Bound<'_, PyAny>,
    read: impl FnOnce(&str) -> Result<T, E>,
) -> PyResult<T> {
    read(text(name, example, argument)?).map_err(|error| value(format_args!("{name}: {error}")))
}

/// Reads the volume that is sucked back after a dose, mL.
pub(crate) fn retracted_ml(retract: Option<&Bound<'_, PyAny>>) -> PyResult<Option<f64>> {
    retract.map(|retract| quantity("retract", "0.1mL", retract, units::volume_ml)).transpose()
}
