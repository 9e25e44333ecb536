//! Flows and pressures over time, as columns.

use numpy::{PyArray1, PyArrayMethods};
use pump_bench::simulation::{COLUMNS, Course, Waveform};
use pump_model::Leg;
use pyo3::exceptions::{PyAttributeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::cavitation::Pressures;
use super::checked::check_columns;
use crate::argument::Floats;
use crate::python::errors::{self, value};
use crate::python::{SignalCheck, frozen, renamed, reserve};

/// Number of samples between two looks at the clock.
const BLOCK: usize = 64;

/// Number of legs from which a bound is tried before the extremes between samples are sought.
const MANY_LEGS: usize = 64;

/// Names of the columns, in their order.
const NAMES: [&str; COLUMNS] = [
    "time_s",
    "angle_rad",
    "speed_rad_s",
    "inlet_flow_ml_s",
    "outlet_flow_ml_s",
    "inlet_kpa",
    "outlet_kpa",
    "delivered_ml",
];

/// Names that the columns had before, which the command's `--trace` keeps, and their names.
const FORMER: [(&str, &str); 4] = [
    ("q_in_ml_s", "inlet_flow_ml_s"),
    ("q_out_ml_s", "outlet_flow_ml_s"),
    ("p_in_kpa", "inlet_kpa"),
    ("p_out_kpa", "outlet_kpa"),
];

/// Flows and pressures of a pump over time: columns of equal length, read-only arrays of float64.
///
/// `Pump.simulate` and `Plan.trace` make runs. `len(run)` is the number of samples.
#[pyclass(frozen, get_all, module = "pumpmodel")]
pub(crate) struct Run {
    /// Time, s; shape (n,).
    time_s: Py<PyArray1<f64>>,
    /// Angle of the pump head, rad, unwrapped; shape (n,).
    angle_rad: Py<PyArray1<f64>>,
    /// Speed of the pump head, rad/s; shape (n,).
    speed_rad_s: Py<PyArray1<f64>>,
    /// Flow at the inlet rollers, mL/s; shape (n,).
    inlet_flow_ml_s: Py<PyArray1<f64>>,
    /// Flow at the outlet rollers, mL/s; shape (n,).
    outlet_flow_ml_s: Py<PyArray1<f64>>,
    /// Pressure at the inlet, kPa absolute; shape (n,).
    inlet_kpa: Py<PyArray1<f64>>,
    /// Pressure at the outlet, kPa absolute; shape (n,).
    outlet_kpa: Py<PyArray1<f64>>,
    /// Volume that has passed the outlet line, mL; shape (n,).
    delivered_ml: Py<PyArray1<f64>>,
    /// State of the lines at the last sample, or None.
    #[pyo3(name = "_end_state")]
    end_state: Py<PyAny>,
    /// Derivatives of pressures and delivered volume, a `Sensitivity`; None unless `Pump.simulate` was asked for it.
    #[pyo3(name = "_sensitivity")]
    sensitivity: Py<PyAny>,
}

#[pymethods]
impl Run {
    /// Return the columns as a table. Needs pandas.
    ///
    /// Returns
    /// -------
    /// pandas.DataFrame
    ///     Table of the columns of `to_dict`, each of shape (n,). `attrs["units"]` has their units.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If pandas is not installed: `pip install "./crates/pump-py[dataframe]"`.
    fn to_dataframe<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pumpmodel._results.tables")?.call_method1("run_dataframe", (slf,))
    }

    /// Return the columns over `time_s`. Needs xarray.
    ///
    /// Returns
    /// -------
    /// xarray.Dataset
    ///     One variable for each column of `to_dict`, of shape (n,), over the coordinate `time_s`. Each has the
    ///     attributes `units` and `long_name`.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If xarray is not installed: `pip install "./crates/pump-py[xarray]"`.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pumpmodel._results.tables")?.call_method1("run_xarray", (slf,))
    }

    /// Return the columns by their names.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Read-only arrays of shape (n,), without a copy. A run with sensitivities has their columns too, as
    ///     `run.sensitivity.to_dict` names them.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let dict = py.import("pumpmodel._results.renamed")?.call_method0("Columns")?;
        for (name, column) in NAMES.into_iter().zip(self.columns()) {
            dict.set_item(name, column)?;
        }
        if !self.sensitivity.is_none(py) {
            let derivatives = self.sensitivity.bind(py).call_method0("to_dict")?;
            derivatives.call_method1("pop", (NAMES[0],))?;
            dict.call_method1("update", (derivatives,))?;
        }
        Ok(dict)
    }

    /// Return the run of the columns that `to_dict` gave.
    ///
    /// Parameters
    /// ----------
    /// data : mapping or pandas.DataFrame
    ///     Eight columns by their names, or by those of the command's `--trace`; array_like of equal length. The
    ///     columns of sensitivities may stand beside them, all or none.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `data` has no columns by name.
    /// ValueError
    ///     If a column is missing, unknown or given by both names, if its length differs, if a number is not finite, or
    ///     if the times do not rise.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = data.py();
        let data = &columns_of(data)?;
        let sensitivity = py.import("pumpmodel._results.sensitivity")?;
        let derivatives = sensitivity.getattr("COLUMNS")?;
        let is_known = |name: &Bound<'_, PyAny>| {
            Ok::<_, PyErr>(name.extract().is_ok_and(is_column) || derivatives.contains(name)?)
        };
        for name in data.keys() {
            if is_known(&name)? {
                continue;
            }
            return Err(value(format_args!(
                "{name} is not a column of a run; allowed: {}; leave it out, as with DataFrame.drop(columns=...)",
                NAMES.join(", ")
            )));
        }
        let mut columns: [Vec<f64>; COLUMNS] = Default::default();
        for (name, column) in NAMES.into_iter().zip(&mut columns) {
            let former = former_name(name);
            let by_former = former.map_or(Ok(None), |former| data.get_item(former))?;
            let numbers = match (data.get_item(name)?, by_former) {
                (Some(numbers), None) | (None, Some(numbers)) => numbers,
                (None, None) => return Err(value(format_args!("the column {name} is missing"))),
                (Some(_), Some(_)) => {
                    let former = former.unwrap_or_default();
                    return Err(value(format_args!("{name} and {former} are one column; give one of them")));
                }
            };
            *column = Floats::extract(name, &numbers)?.into_values()?;
        }
        check_columns(NAMES, &columns)?;
        let run = Self::new(py, columns, py.None(), py.None())?;
        let derivatives = sensitivity.call_method1("from_columns", (data, run.time_s.bind(py)))?;
        Ok(run.with_sensitivity(derivatives.unbind()))
    }

    /// Deprecated name of `inlet_flow_ml_s`.
    #[getter]
    fn q_in_ml_s(slf: &Bound<'_, Self>) -> PyResult<Py<PyArray1<f64>>> {
        Self::by_former_name(slf, "q_in_ml_s", &slf.get().inlet_flow_ml_s)
    }

    /// Deprecated name of `outlet_flow_ml_s`.
    #[getter]
    fn q_out_ml_s(slf: &Bound<'_, Self>) -> PyResult<Py<PyArray1<f64>>> {
        Self::by_former_name(slf, "q_out_ml_s", &slf.get().outlet_flow_ml_s)
    }

    /// Deprecated name of `inlet_kpa`.
    #[getter]
    fn p_in_kpa(slf: &Bound<'_, Self>) -> PyResult<Py<PyArray1<f64>>> {
        Self::by_former_name(slf, "p_in_kpa", &slf.get().inlet_kpa)
    }

    /// Deprecated name of `outlet_kpa`.
    #[getter]
    fn p_out_kpa(slf: &Bound<'_, Self>) -> PyResult<Py<PyArray1<f64>>> {
        Self::by_former_name(slf, "p_out_kpa", &slf.get().outlet_kpa)
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.time_s.bind(py).len()
    }

    fn __eq__(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        for (mine, theirs) in self.columns().into_iter().zip(other.columns()) {
            if mine.bind(py).try_readonly()?.as_slice()? != theirs.bind(py).try_readonly()?.as_slice()? {
                return Ok(false);
            }
        }
        let (mine, theirs) = (self.sensitivity.bind(py), other.sensitivity.bind(py));
        match (mine.is_none(), theirs.is_none()) {
            (true, true) => Ok(true),
            (false, false) => {
                py.import("pumpmodel._results.sensitivity")?.call_method1("equal", (mine, theirs))?.extract()
            }
            _ => Ok(false),
        }
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let range = |column: &Py<PyArray1<f64>>| -> PyResult<String> {
            let column = column.bind(py).try_readonly()?;
            let (low, high) = column
                .as_slice()?
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
            Ok(format!("{low:.4} to {high:.4}"))
        };
        Ok(format!(
            "<Run of {} samples: time_s {}, inlet_kpa {}, outlet_kpa {}, delivered_ml {}>",
            self.__len__(py)?,
            range(&self.time_s)?,
            range(&self.inlet_kpa)?,
            range(&self.outlet_kpa)?,
            range(&self.delivered_ml)?,
        ))
    }

    /// State of the lines at the last sample, from which another run may go on. A run of the roller-centric model or of
    /// `from_dict` has none and raises AttributeError.
    #[getter]
    fn end_state(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        if self.end_state.is_none(py) {
            return Err(PyAttributeError::new_err(
                "a run of the roller-centric model or of from_dict has no end_state; allowed: a run of the \
                 flow-centric model by simulate or trace",
            ));
        }
        Ok(self.end_state.clone_ref(py))
    }

    /// Derivatives of pressures and delivered volume. A run of `Pump.simulate` that was not asked for them has none and
    /// raises AttributeError.
    #[getter]
    fn sensitivity(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        if self.sensitivity.is_none(py) {
            return Err(PyAttributeError::new_err(
                "this run has no sensitivity; allowed: a run of simulate with sensitivity=True",
            ));
        }
        Ok(self.sensitivity.clone_ref(py))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let columns = self.columns().into_iter().map(|column| column.bind(py).as_any());
        let parts = PyTuple::new(
            py,
            columns.chain([self.end_state.bind(py), self.sensitivity.bind(py)]).collect::<Vec<_>>(),
        )?;
        Ok((py.get_type::<Self>().getattr("_rebuild")?, parts))
    }

    #[staticmethod]
    #[pyo3(signature = (*parts))]
    fn _rebuild(py: Python<'_>, mut parts: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        // Runs that were pickled before had no state, or no derivatives.
        let mut part = |most: usize| if parts.len() > most { parts.pop() } else { None };
        let [sensitivity, end_state] =
            [part(COLUMNS + 1), part(COLUMNS)].map(|part| part.map_or_else(|| py.None(), Bound::unbind));
        let copied = |column| Floats::extract("a column of a run", column)?.into_values();
        let columns = parts.iter().map(copied).collect::<PyResult<Vec<_>>>()?;
        match <[Vec<f64>; COLUMNS]>::try_from(columns) {
            Ok(columns) if columns.iter().all(|column| column.len() == columns[0].len()) => {
                Self::new(py, columns, end_state, sensitivity)
            }
            _ => Err(value("these are not the 8 columns of equal length that a run needs")),
        }
    }
}

/// Returns columns by their names, of a dict, another mapping or a table of pandas.
fn columns_of<'py>(data: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
    if let Ok(dict) = data.cast::<PyDict>() {
        return Ok(dict.clone());
    }
    if !(data.hasattr("keys")? && data.hasattr("__getitem__")?) {
        return Err(PyTypeError::new_err(format!(
            "data must have columns by name, not be a {}; allowed: a dict, as of run.to_dict(), another mapping, or a \
             DataFrame, as of pandas.read_csv",
            data.get_type().name()?
        )));
    }
    let dict = PyDict::new(data.py());
    for name in data.call_method0("keys")?.try_iter()? {
        let name = name?;
        dict.set_item(&name, data.get_item(&name)?)?;
    }
    Ok(dict)
}

/// Returns true for the name of a column, also a former one.
fn is_column(name: &str) -> bool {
    NAMES.contains(&name) || FORMER.iter().any(|(former, _)| *former == name)
}

/// Returns the name that a column had before, if it had another one.
fn former_name(name: &str) -> Option<&'static str> {
    FORMER.iter().find(|(_, now)| *now == name).map(|(former, _)| *former)
}

impl Run {
    /// Returns a column by its former name, with a warning.
    fn by_former_name(
        slf: &Bound<'_, Self>,
        former: &str,
        column: &Py<PyArray1<f64>>,
    ) -> PyResult<Py<PyArray1<f64>>> {
        let now = FORMER.iter().find(|(name, _)| *name == former).map_or(former, |(_, now)| *now);
        renamed(slf.py(), &format!("Run.{former}"), &format!("Run.{now}"))?;
        Ok(column.clone_ref(slf.py()))
    }

    fn new(
        py: Python<'_>,
        columns: [Vec<f64>; COLUMNS],
        end_state: Py<PyAny>,
        sensitivity: Py<PyAny>,
    ) -> PyResult<Self> {
        let [time, angle, speed, q_in, q_out, p_in, p_out, delivered] = columns;
        Ok(Self {
            time_s: frozen(py, time)?,
            angle_rad: frozen(py, angle)?,
            speed_rad_s: frozen(py, speed)?,
            inlet_flow_ml_s: frozen(py, q_in)?,
            outlet_flow_ml_s: frozen(py, q_out)?,
            inlet_kpa: frozen(py, p_in)?,
            outlet_kpa: frozen(py, p_out)?,
            delivered_ml: frozen(py, delivered)?,
            end_state,
            sensitivity,
        })
    }

    /// Returns the run with derivatives.
    pub(super) fn with_sensitivity(self, sensitivity: Py<PyAny>) -> Self {
        Self { sensitivity, ..self }
    }

    /// Warns once if a pressure is below 0 kPa absolute, at a sample or between two. `course` is the motion from its
    /// start to the last sample, over these legs.
    pub(crate) fn warn_of_cavitation(
        &self,
        py: Python<'_>,
        course: Course<'_>,
        legs: &(impl Iterator<Item = Leg> + Clone + Sync),
    ) -> PyResult<()> {
        let (inlet, outlet) =
            (self.inlet_kpa.bind(py).try_readonly()?, self.outlet_kpa.bind(py).try_readonly()?);
        let (inlet_kpa, outlet_kpa) = (inlet.as_slice()?, outlet.as_slice()?);
        if legs.clone().take(MANY_LEGS).count() == MANY_LEGS {
            let times = self.time_s.bind(py).try_readonly()?;
            let start_s = legs.clone().next().map_or(0.0, |leg| leg.start_s);
            let (longest_s, _) =
                times.as_slice()?.iter().fold((0.0_f64, start_s), |(longest_s, before_s), time_s| {
                    (longest_s.max(time_s - before_s), *time_s)
                });
            if course.stays_above(0.0, legs, [inlet_kpa, outlet_kpa], longest_s) {
                return Ok(());
            }
        }
        let exact = SignalCheck::during(py, |goes_on| course.extremes(legs, goes_on))?;
        match exact.map_err(errors::integration)? {
            Some([inlet, outlet]) => Pressures { inlet_kpa: &[inlet.min_kpa], outlet_kpa: &[outlet.min_kpa] }
                .warn(py, |_| String::new()),
            None => Pressures { inlet_kpa, outlet_kpa }.warn(py, |_| String::new()),
        }
    }

    /// Returns the times, s.
    pub(super) fn time_s<'a, 'py>(&'a self, py: Python<'py>) -> &'a Bound<'py, PyArray1<f64>> {
        self.time_s.bind(py)
    }

    /// Returns the angles of the pump head, rad.
    pub(super) fn angle_rad<'a, 'py>(&'a self, py: Python<'py>) -> &'a Bound<'py, PyArray1<f64>> {
        self.angle_rad.bind(py)
    }

    /// Returns the delivered volumes, mL.
    pub(super) fn delivered_ml<'a, 'py>(&'a self, py: Python<'py>) -> &'a Bound<'py, PyArray1<f64>> {
        self.delivered_ml.bind(py)
    }

    /// Computes the samples, about `count` of them, while other Python threads run.
    pub(crate) fn collect(
        py: Python<'_>,
        count: u64,
        mut waveform: Waveform<
            '_,
            impl Iterator<Item = Leg> + Clone + Send,
            impl Iterator<Item = f64> + Send,
        >,
    ) -> PyResult<Self> {
        let [inlet, outlet] = waveform.reservoirs_kpa();
        let (columns, end) = py.detach(|| -> PyResult<_> {
            let mut columns: [Vec<f64>; COLUMNS] = Default::default();
            for column in &mut columns {
                reserve(column, count)?;
            }
            let mut interrupt = SignalCheck::new();
            let mut block = [[0.0; BLOCK]; COLUMNS];
            loop {
                interrupt.check()?;
                let places = block.each_mut().map(|column| column.as_mut_slice());
                let filled = waveform.fill(places).map_err(errors::integration)?;
                for (column, new) in columns.iter_mut().zip(&block) {
                    column.extend_from_slice(&new[..filled]);
                }
                if filled < BLOCK {
                    return Ok((columns, waveform.end_states().map_err(errors::integration)?));
                }
            }
        })?;
        let end_state = match end {
            Some([at_inlet, at_outlet]) => {
                let numbers = [
                    inlet + at_inlet.above_reservoir_kpa,
                    at_inlet.flow_ml_s,
                    outlet + at_outlet.above_reservoir_kpa,
                    at_outlet.flow_ml_s,
                ];
                let states = py.import("pumpmodel")?.getattr("LineStates")?;
                states.call1(PyTuple::new(py, numbers)?)?.unbind()
            }
            None => py.None(),
        };
        Self::new(py, columns, end_state, py.None())
    }

    /// Returns the columns in the order of [`NAMES`].
    fn columns(&self) -> [&Py<PyArray1<f64>>; COLUMNS] {
        [
            &self.time_s,
            &self.angle_rad,
            &self.speed_rad_s,
            &self.inlet_flow_ml_s,
            &self.outlet_flow_ml_s,
            &self.inlet_kpa,
            &self.outlet_kpa,
            &self.delivered_ml,
        ]
    }
}
