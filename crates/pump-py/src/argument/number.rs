//! Single numbers.

use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyFloat;

use super::speed::Argument;
use crate::python::errors::value;

/// Endings of names and the units that they stand for, a longer ending before those that it ends with.
const UNITS: [(&str, &str); 22] = [
    ("_ml_deg", "mL over powers of deg"),
    ("_kpa_s2_ml", "kPa s²/mL"),
    ("_kpa_s_ml", "kPa s/mL"),
    ("_ml_kpa", "mL/kPa"),
    ("_ml_s", "mL/s"),
    ("_per_kpa", "1/kPa"),
    ("_rad_s", "rad/s"),
    ("_mpa_s", "mPa s"),
    ("_kg_m3", "kg/m³"),
    ("_rpm", "r/min"),
    ("ml_per_rev", "mL"),
    ("_kpa", "kPa"),
    ("_mpa", "MPa"),
    ("_ml", "mL"),
    ("_mm", "mm"),
    ("_degc", "degC"),
    ("_deg", "deg"),
    ("_rad", "rad"),
    ("_percent", "%"),
    ("_g", "g"),
    ("_s", "s"),
    ("_m", "m"),
];

/// Returns " in" and the unit that the name of an argument ends with, or nothing.
pub(super) fn in_unit(name: &str) -> String {
    let unit = UNITS.iter().find(|(ending, _)| name.ends_with(ending));
    unit.map(|(_, unit)| format!(" in {unit}")).unwrap_or_default()
}

/// Reads the number of the argument `name`: a float, or what Python turns into one.
///
/// # Errors
///
/// `TypeError` for anything that is no number, `ValueError` for a whole number that no float holds. Both name the
/// argument and its unit.
pub(crate) fn number(name: &str, given: &Bound<'_, PyAny>) -> PyResult<f64> {
    number_of(name, &in_unit(name), given)
}

/// Reads the number of the argument `name` if it is given.
///
/// # Errors
///
/// Those of [`number`].
pub(crate) fn optional(name: &str, given: Argument<'_, '_>) -> PyResult<Option<f64>> {
    given.map(|given| number(name, given)).transpose()
}

/// Reads a number that an argument returned at some place. `in_unit` is empty, or its unit after " in ".
///
/// # Errors
///
/// Those of [`number`].
pub(crate) fn number_of(place: &str, in_unit: &str, given: &Bound<'_, PyAny>) -> PyResult<f64> {
    if let Ok(number) = given.cast::<PyFloat>() {
        return Ok(number.value());
    }
    given.extract::<f64>().map_err(|error| {
        let py = given.py();
        if error.is_instance_of::<PyOverflowError>(py) {
            return value(format_args!(
                "{place} is a whole number beyond 1.8e308; allowed: a finite number{in_unit}"
            ));
        }
        if !error.is_instance_of::<PyTypeError>(py) {
            return error;
        }
        match given.get_type().name() {
            Ok(kind) => PyTypeError::new_err(format!("{place} must be a number{in_unit}, not {kind}")),
            Err(error) => error,
        }
    })
}

/// Returns the float of an argument. `unit` is that of a name that does not end with it.
#[pyfunction]
#[pyo3(signature = (name, argument, unit=None))]
pub(crate) fn _number(name: &str, argument: &Bound<'_, PyAny>, unit: Option<&str>) -> PyResult<f64> {
    match unit {
        Some(unit) => number_of(name, &format!(" in {unit}"), argument),
        None => number(name, argument),
    }
}
