//! Resistance, compliance and inertance of one line from several pressure waveforms.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pump_bench::export::Fitted;
use pump_bench::identification::{
    JointlyIdentified, JointlyRecorded, Parameter, PressureRecord, identified_jointly_while,
};
use pump_model::Port;
use pump_model::identification::{PressureSample, Recording};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use super::answer::refused;
use super::column::column;
use super::waveform::{sought_of, turning};
use crate::argument::speed::speed_rad_s;
use crate::argument::{Items, optional, port_named};
use crate::line::Line;
use crate::pump::{Pump, pump_given};
use crate::python::errors::value;
use crate::python::{SignalCheck, collected, frozen};

type Object<'py> = Bound<'py, PyAny>;

/// Times, pressures, both speeds, the beginning, start, start angle and noise of a record.
type Given<'py> = (
    Object<'py>,
    Object<'py>,
    Option<Object<'py>>,
    Option<Object<'py>>,
    String,
    Option<Object<'py>>,
    Option<Object<'py>>,
    Option<Object<'py>>,
);

/// Name, value, standard uncertainty, and whether the parameter was held.
type Told = (&'static str, f64, f64, bool);

/// Parameters, number of samples, independent samples, then times, measured and fitted pressures of a record.
type Recorded<'py> = ([Told; 2], usize, f64, [Bound<'py, PyArray1<f64>>; 3]);

/// Parameters of the line, the records, the covariances, the warnings and the line.
type Answer<'py> = ([Told; 4], Vec<Recorded<'py>>, Bound<'py, PyArray2<f64>>, Vec<String>, Line);

/// Finds R, C and L from several waveforms.
#[pyfunction]
pub(crate) fn _identify_line_jointly<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = pump_given)] pump: Py<Pump>,
    port: &str,
    recordings: Items<Given<'py>>,
    fit: Vec<String>,
) -> PyResult<Answer<'py>> {
    let pump = pump.get();
    let port = port_named(port)?;
    let sought = sought_of(&fit)?;
    let mut records = Vec::new();
    for (n, given) in recordings.0.into_iter().enumerate() {
        records.push(record(pump, port, given).map_err(|error| in_recording(py, n, error))?);
    }
    if records.is_empty() {
        return Err(value("recordings is empty; allowed: one PressureRecord at least"));
    }
    let known = records.iter().filter(|record| record.standard_kpa != UNKNOWN_KPA).count();
    if known != 0 && known != records.len() {
        return Err(value(format_args!(
            "standard_kpa is given for {known} of {} recordings; allowed: in kPa for all of them, or for none",
            records.len()
        )));
    }
    records.iter_mut().filter(|_| known == 0).for_each(|record| record.standard_kpa = 1.0);
    let found = SignalCheck::during(py, |goes_on| {
        identified_jointly_while(pump.model(), port, &records, sought, goes_on)
    })?;
    answer(py, found.map_err(refused)?)
}

/// Noise of a record that says none.
const UNKNOWN_KPA: f64 = 0.0;

/// Reads a record and refuses samples that are not allowed.
fn record(pump: &Pump, port: Port, given: Given<'_>) -> PyResult<PressureRecord> {
    let (time_s, pressure_kpa, rpm, rad_s, begin, start_s, start_angle_rad, standard_kpa) = given;
    let start_s = optional("start_s", start_s.as_ref())?;
    let start_angle_rad = optional("start_angle_rad", start_angle_rad.as_ref())?;
    let standard_kpa = optional("standard_kpa", standard_kpa.as_ref())?;
    if let Some(kpa) = standard_kpa.filter(|kpa| !(kpa.is_finite() && *kpa > 0.0)) {
        return Err(value(format_args!("standard_kpa is {kpa}; allowed: a positive number in kPa")));
    }
    let speed_rad_s = speed_rad_s(rpm.as_ref(), rad_s.as_ref())?;
    let turning = turning(pump, &begin, start_s, start_angle_rad, speed_rad_s)?;
    let times = column("time_s", &time_s, None)?;
    let pressures = column("pressure_kpa", &pressure_kpa, Some(times.len()))?;
    let samples = times.into_iter().zip(pressures);
    let samples = collected(samples.map(|(time_s, pressure_kpa)| PressureSample { time_s, pressure_kpa }))?;
    let legs = turning.legs();
    Recording { port, samples: &samples, motion: turning.motion(&legs) }.validate().map_err(refused)?;
    Ok(PressureRecord {
        samples,
        turning,
        seeks_angle: start_angle_rad.is_none(),
        standard_kpa: standard_kpa.unwrap_or(UNKNOWN_KPA),
    })
}

/// Returns a refusal with the record that it is of.
fn in_recording(py: Python<'_>, n: usize, error: PyErr) -> PyErr {
    let text = format!("recordings[{n}]: {}", error.value(py));
    if error.is_instance_of::<PyTypeError>(py) {
        PyTypeError::new_err(text)
    } else if error.is_instance_of::<PyValueError>(py) {
        PyValueError::new_err(text)
    } else {
        error
    }
}

/// Converts a line that was found.
fn answer(py: Python<'_>, found: JointlyIdentified) -> PyResult<Answer<'_>> {
    let mut recordings = Vec::new();
    for recorded in &found.recordings {
        let JointlyRecorded { parameters, rows, points, independent, .. } = recorded;
        let array = |number: fn(&Fitted) -> f64| {
            frozen(py, collected(points.iter().map(number))?).map(|array| array.into_bound(py))
        };
        let columns = [array(|point| point.x)?, array(|point| point.measured)?, array(|point| point.fitted)?];
        recordings.push((parameters.each_ref().map(told), *rows, *independent, columns));
    }
    let side = found.covariance.len().isqrt();
    let covariance = PyArray1::from_vec(py, found.covariance).reshape([side, side])?;
    covariance.try_readwrite()?.make_nonwriteable();
    Ok((found.parameters.each_ref().map(told), recordings, covariance, found.warnings, Line(found.line)))
}

fn told(parameter: &Parameter) -> Told {
    (parameter.key, parameter.found.value, parameter.found.standard, parameter.is_held)
}
