//! Measures of how well a model meets a measurement.

use pump_model::metrics;
use pyo3::prelude::*;

use crate::argument::Floats;
use crate::python::errors::value;

/// Return the root of the mean square of model less measured.
///
/// Parameters
/// ----------
/// model, measured : array_like
///     Numbers of one shape, in one unit.
///
/// Returns
/// -------
/// float
///     RMSE, in the unit of the numbers.
///
/// Raises
/// ------
/// ValueError
///     If the shapes differ, a number is not finite, or the arrays are empty.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> pm.rmse([1.0, 4.0], [2.0, 3.0])
/// 1.0
#[pyfunction]
pub(crate) fn rmse(model: &Bound<'_, PyAny>, measured: &Bound<'_, PyAny>) -> PyResult<f64> {
    let (model, measured) = both(model, measured)?;
    metrics::rmse(pairs(&model, &measured))
        .ok_or_else(|| value("model and measured are empty; allowed: one number at least"))
}

/// Return the RMSE over the absolute mean of the measurement, as McIntyre et al. report it.
///
/// Parameters
/// ----------
/// model, measured : array_like
///     Numbers of one shape, in one unit.
///
/// Returns
/// -------
/// float
///     Fraction: 0.02 is 2 %. The mean of absolute pressures is mostly ambient.
///
/// Raises
/// ------
/// ValueError
///     If the shapes differ, a number is not finite, or the mean of the measurement is 0.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> pm.nrmse([210.0, 190.0], [200.0, 200.0])
/// 0.05
#[pyfunction]
pub(crate) fn nrmse(model: &Bound<'_, PyAny>, measured: &Bound<'_, PyAny>) -> PyResult<f64> {
    let (model, measured) = both(model, measured)?;
    metrics::nrmse(pairs(&model, &measured))
        .ok_or_else(|| value("measured is empty or its mean is 0; an RMSE over its mean has no meaning"))
}

/// Return Pearson's correlation of model and measured.
///
/// Parameters
/// ----------
/// model, measured : array_like
///     Numbers of one shape.
///
/// Returns
/// -------
/// float
///     Correlation, -1 to 1: it compares rises and falls, not sizes.
///
/// Raises
/// ------
/// ValueError
///     If the shapes differ, a number is not finite, or one of them does not change.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> round(pm.pearson([1.0, 2.0, 3.0], [10.0, 12.0, 14.0]), 12)
/// 1.0
#[pyfunction]
pub(crate) fn pearson(model: &Bound<'_, PyAny>, measured: &Bound<'_, PyAny>) -> PyResult<f64> {
    let (model, measured) = both(model, measured)?;
    metrics::pearson(pairs(&model, &measured))
        .ok_or_else(|| value("model or measured does not change; a correlation has no meaning"))
}

/// Reads both, which must have one shape.
fn both(model: &Bound<'_, PyAny>, measured: &Bound<'_, PyAny>) -> PyResult<(Floats, Floats)> {
    let model = Floats::read("model", model, f64::MAX)?;
    let measured = Floats::read("measured", measured, f64::MAX)?;
    let (one, other) = (model.shape(), measured.shape());
    if one != other {
        return Err(value(format_args!(
            "model has shape {one:?} and measured has shape {other:?}; allowed: equal shapes"
        )));
    }
    Ok((model, measured))
}

/// Pairs both, number by number.
fn pairs(model: &Floats, measured: &Floats) -> impl Iterator<Item = (f64, f64)> + Clone {
    model.values().iter().copied().zip(measured.values().iter().copied())
}
