//! An identified line on its way to `pumpmodel.Identified`.

use numpy::{PyArray1, PyArrayMethods};
use pump_bench::export::Fitted;
use pump_bench::identification::Identified;
use pump_model::identification::IdentificationError;
use pyo3::prelude::*;

use crate::line::Line;
use crate::python::advice;
use crate::python::errors::{self, value};

/// JSON and text of the command, the line, then the varied, the measured and the fitted numbers.
pub(super) type IdentificationAnswer<'py> =
    (String, String, Line, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Converts an identified line, or the error of the search.
pub(super) fn answer(
    py: Python<'_>,
    found: Result<Identified, IdentificationError>,
) -> PyResult<IdentificationAnswer<'_>> {
    let found = found.map_err(|error| match error {
        IdentificationError::Model(error) => errors::model(error),
        _ => value(error),
    })?;
    let found = found.worded(advice::words);
    let array = |number: fn(&Fitted) -> f64| {
        let array = PyArray1::from_iter(py, found.points.iter().map(number));
        array.try_readwrite()?.make_nonwriteable();
        PyResult::Ok(array)
    };
    Ok((
        found.json(),
        found.text(),
        Line(found.line),
        array(|point| point.x)?,
        array(|point| point.measured)?,
        array(|point| point.fitted)?,
    ))
}
