//! The steps of a plan, its predicted waveform, and its report as plain data.

use numpy::PyArray1;
use pump_bench::Prepared;
use pump_bench::simulation::{Course, Method, Waveform, times};
use pump_ctl::plan::Step;
use pump_model::LineState;
use pyo3::prelude::*;

use super::plan::Plan;
use crate::argument::{Argument, optional};
use crate::python::errors::{self, value};
use crate::python::{frozen, reserve};
use crate::simulation::Run;

/// Largest number of rows of a trace, as in the command.
const MAX_ROWS: f64 = 1e9;

#[pymethods]
impl Plan {
    /// Time of every motor step, s; read-only, shape (abs(steps) + abs(retract_steps),). The retraction begins once the
    /// line has settled after the dose.
    #[getter]
    fn step_times_s(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        let times = self.step_times_s.get_or_try_init(py, || {
            frozen(py, self.of_each_step(py, |start_s, step| start_s + step.time_s)?)
        })?;
        Ok(times.clone_ref(py))
    }

    /// Direction of every motor step: 1 forward, -1 in reverse; read-only, of the shape of `step_times_s`.
    #[getter]
    fn step_directions(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        frozen(py, self.of_each_step(py, |_, step| f64::from(step.direction.sign()))?)
    }

    /// Number of motor steps of the retraction, negative; 0 without one.
    #[getter]
    fn retract_steps(&self) -> i64 {
        self.report.retract_steps.unwrap_or(0)
    }

    /// Volume that is sucked back after the dose, mL; 0 without a retraction.
    #[getter]
    fn retraction_ml(&self) -> f64 {
        self.report.retraction_ml.unwrap_or(0.0)
    }

    /// Time from the start until the line has settled after the last step, that of the retraction included, s.
    #[getter]
    fn settled_s(&self) -> f64 {
        self.prepared.settled_s()
    }

    /// Predict flows and pressures over the dose and its retraction, from lines at rest until they have settled.
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
    ///
    /// Warns
    /// -----
    /// UserWarning
    ///     If a pressure is below 0 kPa absolute, where every liquid cavitates and the model has no meaning, also
    ///     between two samples. `Plan.warnings` says it too, beside all else that is doubtful.
    #[pyo3(signature = (*, dt_s=None), text_signature = "($self, *, dt_s=0.001)")]
    fn trace(&self, py: Python<'_>, dt_s: Argument<'_, '_>) -> PyResult<Run> {
        let dt_s = optional("dt_s", dt_s)?.unwrap_or(1e-3);
        let (motion_s, end_s) = (self.prepared.motion_s(), self.prepared.settled_s());
        let least_s = end_s / MAX_ROWS;
        if !(dt_s >= least_s && dt_s.is_finite()) {
            return Err(value(format_args!(
                "dt_s is {dt_s}; allowed: a finite time, {least_s:e} or more for this dose"
            )));
        }
        let model = &self.prepared.model;
        let waveform =
            Waveform::new(model, self.prepared.legs(), Method::Exact, times(dt_s, motion_s, end_s));
        // Rows of the grid, the last step and the end.
        let run = Run::collect(py, (end_s / dt_s) as u64 + 3, waveform.map_err(errors::model)?)?;
        let course = Course { pump: model, method: Method::Exact, states: [LineState::AT_REST; 2], end_s };
        run.warn_of_cavitation(py, course, &self.prepared.legs())?;
        Ok(run)
    }

    /// Return every step, as `dose --steps` writes them. Needs pandas.
    ///
    /// Returns
    /// -------
    /// pandas.DataFrame
    ///     Columns `step`, `time_s`, `direction` and `angle_rad` (after the step), one row for each step of the dose
    ///     and of its retraction. `attrs["units"]` has their units.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If pandas is not installed: `pip install "./crates/pump-py[dataframe]"`.
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
    ///     If xarray is not installed: `pip install "./crates/pump-py[xarray]"`.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pumpmodel._results.tables")?.call_method1("plan_xarray", (slf,))
    }

    /// Angle of the pump head after every step, rad; read-only, of the shape of `step_times_s`.
    #[getter]
    fn step_angles_rad(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        frozen(py, self.of_each_step(py, |_, step| step.angle_rad)?)
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

impl Plan {
    /// Returns a number of every step of the dose and of its retraction, from the time at which its motion starts and
    /// the step.
    fn of_each_step(&self, py: Python<'_>, number: impl Fn(f64, Step) -> f64 + Sync) -> PyResult<Vec<f64>> {
        let Prepared { plan, retraction, prediction, .. } = &self.prepared;
        let back_s = plan.profile().duration_s() + prediction.settle_s;
        let back = retraction.iter().map(|back| (back_s, &back.plan));
        let motions: Vec<_> = [(0.0, plan)].into_iter().chain(back).collect();
        py.detach(|| {
            let mut numbers = Vec::new();
            reserve(&mut numbers, motions.iter().map(|(_, plan)| plan.steps().unsigned_abs()).sum())?;
            for (start_s, plan) in motions {
                numbers.extend(plan.each_step().map(|step| number(start_s, step)));
            }
            Ok(numbers)
        })
    }
}
