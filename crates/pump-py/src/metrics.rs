//! How well a model meets what was measured.

use pump_model::metrics;
use pyo3::prelude::*;

use crate::errors::value;
use crate::floats::Floats;

/// Root of the mean square of model less measured.
///
/// Parameters
/// ----------
/// model, measured : array_like
///     Numbers of one shape, in one unit.
///
/// Returns
/// -------
/// float
///     In their unit.
///
/// Raises
/// ------
/// ValueError
///     If the shapes differ, a number is not finite or there is none.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> pm.rmse([1.0, 4.0], [2.0, 3.0])
/// 1.0
#[pyfunction]
pub(crate) fn rmse(model: &Bound<'_, PyAny>, measured: &Bound<'_, PyAny>) -> PyResult<f64> {
    let pairs = pairs(model, measured)?;
    metrics::rmse(pairs).ok_or_else(|| value("model and measured are empty; allowed: one number at least"))
}

/// RMSE over the mean of what was measured, without sign, as McIntyre et al. report it.
///
/// Parameters
/// ----------
/// model, measured : array_like
///     Numbers of one shape, in one unit.
///
/// Returns
/// -------
/// float
///     A part: 0.02 is 2 %. Of absolute pressures the mean is mostly ambient.
///
/// Raises
/// ------
/// ValueError
///     If the shapes differ, a number is not finite, or what was measured has a mean of 0.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> pm.nrmse([210.0, 190.0], [200.0, 200.0])
/// 0.05
#[pyfunction]
pub(crate) fn nrmse(model: &Bound<'_, PyAny>, measured: &Bound<'_, PyAny>) -> PyResult<f64> {
    let pairs = pairs(model, measured)?;
    metrics::nrmse(pairs)
        .ok_or_else(|| value("the mean of measured is 0, or of nothing; an RMSE over it has no meaning"))
}

/// Pearson's correlation of model and measured.
///
/// Parameters
/// ----------
/// model, measured : array_like
///     Numbers of one shape.
///
/// Returns
/// -------
/// float
///     -1 to 1: whether both rise and fall together, whatever their size.
///
/// Raises
/// ------
/// ValueError
///     If the shapes differ, a number is not finite, or either does not change.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> pm.pearson([1.0, 2.0, 3.0], [10.0, 12.0, 14.0])
/// 1.0
#[pyfunction]
pub(crate) fn pearson(model: &Bound<'_, PyAny>, measured: &Bound<'_, PyAny>) -> PyResult<f64> {
    let pairs = pairs(model, measured)?;
    metrics::pearson(pairs)
        .ok_or_else(|| value("model or measured does not change; a correlation has no meaning"))
}

/// Both, number by number.
fn pairs(model: &Bound<'_, PyAny>, measured: &Bound<'_, PyAny>) -> PyResult<Vec<(f64, f64)>> {
    let model = Floats::read("model", model, f64::MAX)?;
    let measured = Floats::read("measured", measured, f64::MAX)?;
    let (one, other) = (model.shape(), measured.shape());
    if one != other {
        return Err(value(format_args!(
            "model has the shape {one:?} and measured {other:?}; allowed: one shape"
        )));
    }
    Ok(model.values().iter().copied().zip(measured.values().iter().copied()).collect())
}
