//! The steps of a plan, its predicted waveform, and its report as plain data.

use numpy::PyArray1;
use pump_bench::simulation::{Method, Waveform, times};
use pyo3::prelude::*;

use super::plan::Plan;
use crate::python::errors::{self, value};
use crate::python::{frozen, reserve};
use crate::simulation::Run;

/// Largest number of rows of a trace, as in the command.
const MAX_ROWS: f64 = 1e9;

#[pymethods]
impl Plan {
    /// Time of every motor step, s; read-only, shape (abs(steps),).
    #[getter]
    fn step_times_s(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        let times = self.step_times_s.get_or_try_init(py, || {
            let times = py.detach(|| {
                let mut times = Vec::new();
                reserve(&mut times, self.prepared.plan.steps().unsigned_abs())?;
                times.extend(self.prepared.plan.each_step().map(|step| step.time_s));
                Ok::<_, PyErr>(times)
            })?;
            frozen(py, times)
        })?;
        Ok(times.clone_ref(py))
    }

    /// Predict flows and pressures over the dose, from lines at rest until they have settled.
    ///
    /// Parameters
    /// ----------
    /// dt_s : float
    ///     Time between samples, s. The last step and the end have their own samples.
    ///
    /// Returns
    /// -------
    /// Run
    ///     Flows and pressures over time.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If `dt_s` is not positive, or if more than 1e9 samples would result.
    /// PumpError
    ///     If the solver fails on the way.
    /// MemoryError
    ///     If there is no room for the samples.
    #[pyo3(signature = (*, dt_s=1e-3))]
    fn trace(&self, py: Python<'_>, dt_s: f64) -> PyResult<Run> {
        let motion_s = self.report.motion_s;
        let end_s = motion_s + self.report.settle_s.unwrap_or(0.0);
        let least_s = end_s / MAX_ROWS;
        if !(dt_s >= least_s && dt_s.is_finite()) {
            return Err(value(format_args!(
                "dt_s is {dt_s}; allowed: a finite time, {least_s:e} or more for this dose"
            )));
        }
        let model = &self.prepared.model;
        let legs = self.prepared.plan.legs();
        let waveform = Waveform::new(model, legs, Method::Exact, times(dt_s, motion_s, end_s));
        // Rows of the grid, the last step and the end.
        Run::collect(py, (end_s / dt_s) as u64 + 3, waveform.map_err(errors::model)?)
    }

    /// Return every step, as `dose --steps` writes them. Needs pandas.
    ///
    /// Returns
    /// -------
    /// pandas.DataFrame
    ///     Columns `step`, `time_s`, `direction` and `angle_rad` (after the step), of shape (abs(steps),).
    ///     `attrs["units"]` has their units.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If pandas is not installed: `pip install "pumpmodel[dataframe]"`.
    fn to_dataframe<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pumpmodel._results.tables")?.call_method1("plan_dataframe", (slf,))
    }

    /// Return every step, as `dose --steps` writes them. Needs xarray.
    ///
    /// Returns
    /// -------
    /// xarray.Dataset
    ///     Variables `direction` and `angle_rad` (after the step) over `time_s`. Attributes have the units.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If xarray is not installed: `pip install "pumpmodel[xarray]"`.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pumpmodel._results.tables")?.call_method1("plan_xarray", (slf,))
    }

    /// Angle of the pump head after every step, rad; read-only, shape (abs(steps),).
    #[getter]
    fn step_angles_rad(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        let angles = py.detach(|| {
            let mut angles = Vec::new();
            reserve(&mut angles, self.prepared.plan.steps().unsigned_abs())?;
            angles.extend(self.prepared.plan.each_step().map(|step| step.angle_rad));
            Ok::<_, PyErr>(angles)
        })?;
        frozen(py, angles)
    }

    /// Return the plan as the command reports a dry run: the object `dose/1` of its JSON.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Numbers, texts, lists and dicts only. Angles are in deg, and `delivered_ml` is None.
    pub(crate) fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.call_method1("loads", (self.report.json(),))
    }
}
