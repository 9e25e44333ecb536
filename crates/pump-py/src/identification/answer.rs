//! An identified line on its way to `pumpmodel.Identified`.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pump_bench::export::Fitted;
use pump_bench::identification::Identified;
use pump_model::identification::IdentificationError;
use pyo3::prelude::*;

use crate::line::Line;
use crate::python::advice;
use crate::python::errors::{self, value};
use crate::python::{collected, frozen, no_memory};

/// JSON and text of the command, the line, then the varied, the measured and the fitted numbers, and the covariances.
pub(super) type IdentificationAnswer<'py> =
    (String, String, Line, [Bound<'py, PyArray1<f64>>; 3], Bound<'py, PyArray2<f64>>);

/// Converts an identified line, or the error of the search.
pub(super) fn answer(
    py: Python<'_>,
    found: Result<Identified, IdentificationError>,
) -> PyResult<IdentificationAnswer<'_>> {
    let found = found.map_err(refused)?;
    let found = found.worded(advice::words);
    let array = |number: fn(&Fitted) -> f64| {
        frozen(py, collected(found.points.iter().map(number))?).map(|array| array.into_bound(py))
    };
    // The parameters of the JSON, and so those of `Identified`, are in the order of their keys.
    let sought: Vec<_> = found.parameters.iter().filter(|parameter| !parameter.is_held).collect();
    let count = sought.len();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|n| sought[*n].key);
    let rows = order.iter().flat_map(|row| order.iter().map(move |column| row * count + column));
    let covariance: Vec<f64> = rows.map(|place| found.covariance[place]).collect();
    let covariance = PyArray1::from_vec(py, covariance).reshape([count, count])?;
    covariance.try_readwrite()?.make_nonwriteable();
    Ok((
        found.json(),
        found.text(),
        Line(found.line),
        [array(|point| point.x)?, array(|point| point.measured)?, array(|point| point.fitted)?],
        covariance,
    ))
}

/// Maps an error of the model, of the samples or of the search.
pub(super) fn refused(error: IdentificationError) -> PyErr {
    match error {
        IdentificationError::Model(error) => errors::model(error),
        IdentificationError::NoMemory { given, .. } => no_memory(given as u64),
        _ => value(error),
    }
}
