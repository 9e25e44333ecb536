//! The resistance of a line from steady flows and pressures.

use pump_bench::identification::identified_resistance;
use pump_model::Port;
use pump_model::identification::FlowPoint;
use pyo3::prelude::*;

use super::answer::{IdentificationAnswer, answer};
use super::column::column;
use crate::argument::{Argument, flag, port_named};
use crate::pump::{Pump, pump_given};
use crate::python::collected;
use crate::python::errors::value;

/// Finds R from steady flows, and from absolute pressures at the pump or drops along the flow.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
pub(crate) fn _identify_resistance<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = pump_given)] pump: Py<Pump>,
    port: &str,
    flow_ml_s: &Bound<'py, PyAny>,
    pressure_kpa: Argument<'_, 'py>,
    drop_kpa: Argument<'_, 'py>,
    standard_kpa: Argument<'_, 'py>,
    offset: &Bound<'py, PyAny>,
) -> PyResult<IdentificationAnswer<'py>> {
    let pump = pump.get();
    let port = port_named(port)?;
    let offset = flag("offset", Some(offset))?;
    let line = pump.model().line(port);
    let flows = column("flow_ml_s", flow_ml_s, None)?;
    let count = Some(flows.len());
    // A drop counts along the flow: to the pump at the inlet, from the pump at the outlet.
    let sign = if port == Port::Inlet { -1.0 } else { 1.0 };
    let drops = match (pressure_kpa, drop_kpa) {
        (Some(kpa), None) => {
            let mut at_pump = column("pressure_kpa", kpa, count)?;
            at_pump.iter_mut().for_each(|kpa| *kpa = sign * (*kpa - line.reservoir_kpa));
            at_pump
        }
        (None, Some(kpa)) => column("drop_kpa", kpa, count)?,
        _ => return Err(value("give exactly one of pressure_kpa and drop_kpa")),
    };
    let errors = match standard_kpa {
        Some(kpa) => column("standard_kpa", kpa, count)?,
        None => collected(flows.iter().map(|_| 1.0))?,
    };
    let readings = flows.into_iter().zip(drops).zip(errors);
    let points = collected(readings.map(|((flow_ml_s, drop_kpa), standard_kpa)| FlowPoint {
        flow_ml_s,
        drop_kpa,
        standard_kpa,
    }))?;
    let rate_ml_s = pump.default_rate_ml_s();
    let found = py.detach(|| identified_resistance(&points, offset, (port, line), rate_ml_s));
    answer(py, found.map(|found| found.with_nozzle_of(&pump.file)))
}
