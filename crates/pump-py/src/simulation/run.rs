//! Flows and pressures over time, as columns.

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pump_bench::simulation::{COLUMNS, Waveform};
use pump_model::Leg;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::argument::Floats;
use crate::python::errors::{self, value};
use crate::python::{Interrupt, frozen, reserve};

/// Number of samples between two looks at the clock.
const BLOCK: usize = 64;

/// Names of the columns, in their order.
const NAMES: [&str; COLUMNS] = [
    "time_s",
    "angle_rad",
    "speed_rad_s",
    "q_in_ml_s",
    "q_out_ml_s",
    "p_in_kpa",
    "p_out_kpa",
    "delivered_ml",
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
    q_in_ml_s: Py<PyArray1<f64>>,
    /// Flow at the outlet rollers, mL/s; shape (n,).
    q_out_ml_s: Py<PyArray1<f64>>,
    /// Pressure at the inlet, kPa absolute; shape (n,).
    p_in_kpa: Py<PyArray1<f64>>,
    /// Pressure at the outlet, kPa absolute; shape (n,).
    p_out_kpa: Py<PyArray1<f64>>,
    /// Volume that has passed the outlet line, mL; shape (n,).
    delivered_ml: Py<PyArray1<f64>>,
}

#[pymethods]
impl Run {
    /// Return the columns as a table. Needs pandas.
    ///
    /// Returns
    /// -------
    /// pandas.DataFrame
    ///     Table of the columns, each of shape (n,). `attrs["units"]` has their units.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If pandas is not installed: `pip install "pumpmodel[dataframe]"`.
    fn to_dataframe<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pumpmodel._results.tables")?.call_method1("run_dataframe", (slf,))
    }

    /// Return the columns over `time_s`. Needs xarray.
    ///
    /// Returns
    /// -------
    /// xarray.Dataset
    ///     One variable for each column, of shape (n,), over the coordinate `time_s`. Each has the attributes `units`
    ///     and `long_name`.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If xarray is not installed: `pip install "pumpmodel[xarray]"`.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pumpmodel._results.tables")?.call_method1("run_xarray", (slf,))
    }

    /// Return the columns by their names.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Read-only arrays of shape (n,), without a copy.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, column) in NAMES.into_iter().zip(self.columns()) {
            dict.set_item(name, column)?;
        }
        Ok(dict)
    }

    /// Return the run of the columns that `to_dict` gave.
    ///
    /// Parameters
    /// ----------
    /// data : dict
    ///     Eight columns by their names, array_like of equal length.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a column is missing or unknown, or its length differs.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyDict>) -> PyResult<Self> {
        if let Some(name) =
            data.keys().iter().find(|name| !name.extract().is_ok_and(|name| NAMES.contains(&name)))
        {
            return Err(value(format_args!(
                "{name} is not a column of a run; allowed: {}",
                NAMES.join(", ")
            )));
        }
        let mut columns: [Vec<f64>; COLUMNS] = Default::default();
        for (name, column) in NAMES.into_iter().zip(&mut columns) {
            let Some(numbers) = data.get_item(name)? else {
                return Err(value(format_args!("the column {name} is missing")));
            };
            *column = Floats::extract(name, &numbers)?.values().to_vec();
        }
        if columns.iter().any(|column| column.len() != columns[0].len()) {
            return Err(value("the columns differ in length; a run needs columns of equal length"));
        }
        Self::new(data.py(), columns)
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
        Ok(true)
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
            "<Run of {} samples: time_s {}, p_in_kpa {}, p_out_kpa {}, delivered_ml {}>",
            self.__len__(py)?,
            range(&self.time_s)?,
            range(&self.p_in_kpa)?,
            range(&self.p_out_kpa)?,
            range(&self.delivered_ml)?,
        ))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let columns = PyTuple::new(py, self.columns())?;
        Ok((py.get_type::<Self>().getattr("_rebuild")?, columns))
    }

    #[staticmethod]
    #[pyo3(signature = (*columns))]
    fn _rebuild(py: Python<'_>, columns: Vec<PyReadonlyArray1<'_, f64>>) -> PyResult<Self> {
        let columns =
            columns.iter().map(|column| Ok(column.as_slice()?.to_vec())).collect::<PyResult<Vec<_>>>()?;
        match <[Vec<f64>; COLUMNS]>::try_from(columns) {
            Ok(columns) if columns.iter().all(|column| column.len() == columns[0].len()) => {
                Self::new(py, columns)
            }
            _ => Err(value("these are not the 8 columns of equal length that a run needs")),
        }
    }
}

impl Run {
    fn new(py: Python<'_>, columns: [Vec<f64>; COLUMNS]) -> PyResult<Self> {
        let [time, angle, speed, q_in, q_out, p_in, p_out, delivered] = columns;
        Ok(Self {
            time_s: frozen(py, time)?,
            angle_rad: frozen(py, angle)?,
            speed_rad_s: frozen(py, speed)?,
            q_in_ml_s: frozen(py, q_in)?,
            q_out_ml_s: frozen(py, q_out)?,
            p_in_kpa: frozen(py, p_in)?,
            p_out_kpa: frozen(py, p_out)?,
            delivered_ml: frozen(py, delivered)?,
        })
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
        let columns = py.detach(|| -> PyResult<_> {
            let mut columns: [Vec<f64>; COLUMNS] = Default::default();
            for column in &mut columns {
                reserve(column, count)?;
            }
            let mut interrupt = Interrupt::new();
            let mut block = [[0.0; BLOCK]; COLUMNS];
            loop {
                interrupt.check()?;
                let places = block.each_mut().map(|column| column.as_mut_slice());
                let filled = waveform.fill(places).map_err(errors::integration)?;
                for (column, new) in columns.iter_mut().zip(&block) {
                    column.extend_from_slice(&new[..filled]);
                }
                if filled < BLOCK {
                    return Ok(columns);
                }
            }
        })?;
        Self::new(py, columns)
    }

    /// Returns the columns in the order of [`NAMES`].
    fn columns(&self) -> [&Py<PyArray1<f64>>; COLUMNS] {
        [
            &self.time_s,
            &self.angle_rad,
            &self.speed_rad_s,
            &self.q_in_ml_s,
            &self.q_out_ml_s,
            &self.p_in_kpa,
            &self.p_out_kpa,
            &self.delivered_ml,
        ]
    }
}
