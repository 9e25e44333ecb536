//! Resistance, compliance and inertance of a line from a pressure waveform.

use pump_bench::identification::{Begin, Turning, identified_line_while};
use pump_model::identification::{PressureSample, Sought};
use pyo3::prelude::*;

use super::answer::{IdentificationAnswer, answer};
use super::column::column;
use crate::argument::port_named;
use crate::argument::speed::speed_rad_s;
use crate::argument::{Argument, choice, optional};
use crate::pump::{Pump, pump_given};
use crate::python::errors::value;
use crate::python::{SignalCheck, collected};

/// Motions at the start of a record.
pub(crate) const BEGINS: [&str; 3] = ["ramp", "step", "steady"];

/// Parameters that can be sought.
pub(crate) const PARAMETERS: [&str; 5] = ["R", "C", "L", "reservoir", "start"];

/// Finds R, C and L from a waveform.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
pub(crate) fn _identify_line<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = pump_given)] pump: Py<Pump>,
    port: &str,
    time_s: &Bound<'py, PyAny>,
    pressure_kpa: &Bound<'py, PyAny>,
    speed_rpm: Argument<'_, 'py>,
    speed_rad: Argument<'_, 'py>,
    fit: Vec<String>,
    begin: &str,
    start_s: Argument<'_, 'py>,
    start_angle_rad: Argument<'_, 'py>,
) -> PyResult<IdentificationAnswer<'py>> {
    let pump = pump.get();
    let port = port_named(port)?;
    let start_s = optional("start_s", start_s)?;
    let start_angle_rad = optional("start_angle_rad", start_angle_rad)?;
    let speed_rad_s = speed_rad_s(speed_rpm, speed_rad)?;
    let turning = turning(pump, begin, start_s, start_angle_rad, speed_rad_s)?;
    let sought = sought_of(&fit)?.with_angle(start_angle_rad.is_none());
    let times = column("time_s", time_s, None)?;
    let pressures = column("pressure_kpa", pressure_kpa, Some(times.len()))?;
    let samples = times.into_iter().zip(pressures);
    let samples = collected(samples.map(|(time_s, pressure_kpa)| PressureSample { time_s, pressure_kpa }))?;
    let found = SignalCheck::during(py, |goes_on| {
        identified_line_while(pump.model(), port, &samples, &turning, sought, goes_on)
    })?;
    answer(py, found.map(|found| found.with_nozzle_of(&pump.file)))
}

/// Reads the parameters that are sought, but for the angle.
pub(super) fn sought_of(fit: &[String]) -> PyResult<Sought> {
    if fit.is_empty() {
        let all = PARAMETERS.map(|name| format!("\"{name}\"")).join(", ");
        return Err(value(format_args!("fit is empty; allowed: one name at least of {all}")));
    }
    for name in fit {
        choice("a name in fit", name, &PARAMETERS.map(|allowed| (allowed, ())))?;
    }
    let has = |name: &str| fit.iter().any(|given| given == name);
    Ok(Sought::new()
        .with_resistance(has("R"))
        .with_compliance(has("C"))
        .with_inertance(has("L"))
        .with_start(has("start"))
        .with_pressure(has("reservoir")))
}

/// Reads how the rotor came to its speed, and where it stood.
pub(super) fn turning(
    pump: &Pump,
    begin: &str,
    start_s: Option<f64>,
    start_angle_rad: Option<f64>,
    speed_rad_s: f64,
) -> PyResult<Turning> {
    let ramp = Begin::Ramp { acceleration_rad_s2: pump.file.limits().motor.max_acceleration_rad_s2 };
    let [by_ramp, by_step, steady] = BEGINS;
    let begin = choice("begin", begin, &[(by_ramp, ramp), (by_step, Begin::Step), (steady, Begin::Steady)])?;
    if begin == Begin::Steady && start_s.is_some() {
        return Err(value("start_s is given, but a steady record has no start; leave it out"));
    }
    for (name, number) in [("start_s", start_s), ("start_angle_rad", start_angle_rad)] {
        if let Some(number) = number.filter(|number| !number.is_finite()) {
            return Err(value(format_args!("{name} is {number}; allowed: a finite number")));
        }
    }
    Ok(Turning {
        begin,
        start_s: start_s.unwrap_or(0.0),
        angle_rad: start_angle_rad.unwrap_or(0.0),
        speed_rad_s,
    })
}
