//! An identified line on its way to `pumpmodel.Identified`.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pump_bench::export::Fitted;
use pump_bench::identification::Identified;
use pump_model::identification::{IdentificationError, Readings};
use pump_model::{Parameter, Shown};
use pyo3::prelude::*;

use crate::line::Line;
use crate::python::advice;
use crate::python::errors::{self, value};
use crate::python::{collected, frozen, no_memory};

/// JSON and text of the command, the line, then the varied, the measured and the fitted numbers, the covariances, and
/// the keys of the parameters in the order of the covariances.
pub(super) type IdentificationAnswer<'py> =
    (String, String, Line, [Bound<'py, PyArray1<f64>>; 3], Bound<'py, PyArray2<f64>>, Vec<&'static str>);

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
    let keys = found.parameters.iter().map(|parameter| parameter.key).collect();
    let count = found.covariance.len().isqrt();
    let covariance = PyArray1::from_slice(py, &found.covariance).reshape([count, count])?;
    covariance.try_readwrite()?.make_nonwriteable();
    Ok((
        found.json(),
        found.text(),
        Line(found.line),
        [array(|point| point.x)?, array(|point| point.measured)?, array(|point| point.fitted)?],
        covariance,
        keys,
    ))
}

/// Maps an error of the model, of the samples or of the search.
pub(super) fn refused(error: IdentificationError) -> PyErr {
    match error {
        IdentificationError::Model(error) => errors::model(error),
        IdentificationError::NoMemory { given, .. } => no_memory(given as u64),
        IdentificationError::OutOfRange { parameter, of, number, value: given, allowed } => {
            match reading(parameter, of) {
                Some(name) => {
                    value(format_args!("{name}[{}] is {}; allowed: {allowed}", number - 1, Shown(given)))
                }
                None => value(error),
            }
        }
        _ => value(error),
    }
}

/// Returns the argument that has a reading.
fn reading(parameter: Parameter, of: Readings) -> Option<&'static str> {
    match (of, parameter) {
        (Readings::Samples, Parameter::Time) => Some("time_s"),
        (Readings::Samples, Parameter::AbsolutePressure) | (Readings::VolumePoints, Parameter::Pressure) => {
            Some("pressure_kpa")
        }
        (Readings::VolumePoints, Parameter::Volume) => Some("volume_ml"),
        (Readings::FlowPoints, Parameter::Flow) => Some("flow_ml_s"),
        (Readings::FlowPoints, Parameter::PressureUncertainty) => Some("standard_kpa"),
        _ => None,
    }
}
