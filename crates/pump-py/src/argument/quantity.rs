//! Quantities as text with their unit.

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

/// Reads the volume that is sucked back after a dose, mL.
pub(crate) fn retracted_ml(retract: Option<&Bound<'_, PyAny>>) -> PyResult<Option<f64>> {
    retract.map(|retract| units::volume_ml(text("retract", "0.1mL", retract)?).map_err(value)).transpose()
}
