//! The compliance of a closed line from injected volumes and pressures.

use pump_bench::identification::identified_compliance;
use pump_model::identification::InjectionPoint;
use pyo3::prelude::*;

use super::answer::{IdentificationAnswer, answer};
use super::column::column;
use crate::argument::{Argument, optional, port_named};
use crate::pump::{Pump, pump_given};
use crate::python::collected;
use crate::python::errors::value;

/// Finds C from injected volumes and pressures.
#[pyfunction]
pub(crate) fn _identify_compliance<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = pump_given)] pump: Py<Pump>,
    port: &str,
    volume_ml: &Bound<'py, PyAny>,
    pressure_kpa: &Bound<'py, PyAny>,
    total_ml: Argument<'_, 'py>,
) -> PyResult<IdentificationAnswer<'py>> {
    let pump = pump.get();
    let port = port_named(port)?;
    let total_ml = optional("total_ml", total_ml)?;
    if let Some(total_ml) = total_ml.filter(|ml| !(ml.is_finite() && *ml > 0.0)) {
        return Err(value(format_args!("total_ml is {total_ml}; allowed: a positive number")));
    }
    let volumes = column("volume_ml", volume_ml, None)?;
    let pressures = column("pressure_kpa", pressure_kpa, Some(volumes.len()))?;
    let points = volumes.into_iter().zip(pressures);
    let points =
        collected(points.map(|(volume_ml, pressure_kpa)| InjectionPoint { volume_ml, pressure_kpa }))?;
    let found = py.detach(|| identified_compliance(&points, total_ml, (port, pump.model().line(port))));
    answer(py, found.map(|found| found.with_nozzle_of(&pump.file)))
}
