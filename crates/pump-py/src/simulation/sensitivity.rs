//! Derivatives of a run's pressures and delivered volume, as arrays.

use numpy::{PyArray2, PyArrayMethods};
use pump_bench::simulation::{Derivatives, SensitiveWaveform, interval_s, steady_sensitivities};
use pump_model::{LineState, Pump as Model, SensitiveState, SensitivityParameter};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::motion::{Motion, Times};
use super::run::Run;
use crate::python::errors;
use crate::python::{SignalCheck, frozen_rows, reserve};

/// Number of samples between two looks at the clock.
const BLOCK: usize = 4096;

const PARAMETERS: usize = SensitivityParameter::COUNT;

/// Returns the states of the lines at the start with their derivatives: 0 for states that are given.
pub(super) fn starts(
    model: &Model,
    motion: &Motion,
    states: [LineState; 2],
    is_steady: bool,
) -> PyResult<[SensitiveState; 2]> {
    if !is_steady {
        return Ok(states.map(SensitiveState::fixed));
    }
    let angle_rad = motion.legs.first().map_or(0.0, |leg| leg.angle_rad);
    steady_sensitivities(model, motion.first_rad_s(), angle_rad).map_err(errors::model)
}

/// Returns the derivatives at the samples of `run`, as `pumpmodel.Sensitivity`.
pub(super) fn sensitivity<'py>(
    py: Python<'py>,
    model: &Model,
    motion: &Motion,
    starts: [SensitiveState; 2],
    run: &Run,
) -> PyResult<Bound<'py, PyAny>> {
    let every_s = match &motion.times {
        Times::Every { dt_s, .. } => Some(*dt_s),
        Times::At(times_s) => interval_s(times_s),
    };
    let times = run.time_s(py).try_readonly()?;
    let angles = run.angle_rad(py).try_readonly()?;
    let delivered = run.delivered_ml(py).try_readonly()?;
    let (times, angles, delivered) = (times.as_slice()?, angles.as_slice()?, delivered.as_slice()?);
    let count = times.len();
    let quantities = py.detach(|| -> PyResult<_> {
        let mut quantities: [Vec<f64>; 3] = Default::default();
        for rows in &mut quantities {
            reserve(rows, (PARAMETERS * count) as u64)?;
            rows.resize(PARAMETERS * count, 0.0);
        }
        let legs = motion.legs.iter().copied();
        let mut waveform = SensitiveWaveform::new(model, legs, starts, every_s);
        let mut interrupt = SignalCheck::new();
        let mut left = quantities.each_mut().map(|rows| rows_of(rows, count));
        let blocks = times.chunks(BLOCK).zip(angles.chunks(BLOCK)).zip(delivered.chunks(BLOCK));
        for ((times, angles), delivered) in blocks {
            interrupt.check()?;
            let [inlet_kpa_by, outlet_kpa_by, delivered_ml_by] =
                left.each_mut().map(|rows| rows.each_mut().map(|row| first_of(row, times.len())));
            let to = Derivatives { inlet_kpa_by, outlet_kpa_by, delivered_ml_by };
            waveform.fill([times, angles, delivered], to);
        }
        Ok(quantities)
    })?;
    let [inlet, outlet, delivered] = quantities;
    let arrays: [Py<PyArray2<f64>>; 3] = [
        frozen_rows(py, inlet, PARAMETERS)?,
        frozen_rows(py, outlet, PARAMETERS)?,
        frozen_rows(py, delivered, PARAMETERS)?,
    ];
    let arrays = arrays.iter().map(|array| array.bind(py).as_any());
    let parts = PyTuple::new(py, [run.time_s(py).as_any()].into_iter().chain(arrays).collect::<Vec<_>>())?;
    py.import("pumpmodel")?.getattr("Sensitivity")?.call1(parts)
}

/// Divides the numbers into rows of `count`.
fn rows_of(numbers: &mut [f64], count: usize) -> [&mut [f64]; PARAMETERS] {
    let mut rows = numbers.chunks_exact_mut(count.max(1));
    std::array::from_fn(|_| rows.next().unwrap_or_default())
}

/// Takes the first `count` numbers off a row.
fn first_of<'a>(row: &mut &'a mut [f64], count: usize) -> &'a mut [f64] {
    row.split_off_mut(..count).unwrap_or_default()
}
