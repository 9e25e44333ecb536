//! The periodic steady state, at one speed or at many.

use pump_bench::displacement::{DisplacementError, SpeedDependentPump};
use pump_bench::simulation::SteadyReport;
use pump_model::{Shown, SteadyStates};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::cavitation::Pressures;
use crate::argument::{Argument, Floats, speed};
use crate::pump::Pump;
use crate::python::{SignalCheck, collected, errors};

/// Number of attributes of a steady state but the speed.
pub(super) const NUMBERS: usize = 9;
/// Places of the smallest pressures among them.
const INLET_MIN: usize = 0;
const OUTLET_MIN: usize = 3;
/// Number of attributes of a steady state.
const FIELDS: usize = NUMBERS + 1;

/// Periodic steady state of a pump at constant speed, without any trace of the start.
///
/// `Pump.steady_state` makes steady states. The attributes are floats if the speed was one number, otherwise read-only
/// arrays of the speeds' shape.
#[pyclass(frozen, generic, get_all, module = "pumpmodel")]
pub(crate) struct SteadyState {
    /// Speed of the pump head, r/min; negative in reverse.
    speed_rpm: Py<PyAny>,
    /// Smallest inlet pressure, kPa absolute.
    inlet_min_kpa: Py<PyAny>,
    /// Largest inlet pressure, kPa absolute.
    inlet_max_kpa: Py<PyAny>,
    /// Mean inlet pressure, kPa absolute.
    inlet_mean_kpa: Py<PyAny>,
    /// Smallest outlet pressure, kPa absolute.
    outlet_min_kpa: Py<PyAny>,
    /// Largest outlet pressure, kPa absolute.
    outlet_max_kpa: Py<PyAny>,
    /// Mean outlet pressure, kPa absolute.
    outlet_mean_kpa: Py<PyAny>,
    /// Mean flow, mL/s; negative in reverse.
    mean_flow_ml_s: Py<PyAny>,
    /// (Largest - smallest) / mean of the flow at the outlet rollers.
    ripple_peak_to_peak: Py<PyAny>,
    /// Standard deviation / mean of the flow at the outlet rollers.
    ripple_rms: Py<PyAny>,
}

#[pymethods]
impl Pump {
    /// Compute the periodic steady state at constant speed. Other Python threads run meanwhile.
    ///
    /// A line that is a hose has its resistance at the pump's default rate. `simulate` follows its friction at every
    /// flow.
    ///
    /// Parameters
    /// ----------
    /// speed_rpm : float or array_like
    ///     Speed of the pump head, r/min; negative in reverse; not zero.
    /// speed_rad_s : float or array_like
    ///     Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    ///
    /// Returns
    /// -------
    /// SteadyState
    ///     Attributes are floats for one speed; array input gives arrays of float64 of its shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a speed is not allowed, or a line without resistance resonates at it.
    /// PumpError
    ///     If the solver fails on the way.
    ///
    /// Warns
    /// -----
    /// UserWarning
    ///     If a pressure is below 0 kPa absolute, where every liquid cavitates and the model has no meaning. An array
    ///     of speeds warns once.
    #[pyo3(signature = (*, speed_rpm=None, speed_rad_s=None))]
    fn steady_state<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
    ) -> PyResult<SteadyState> {
        SteadyState::at(py, self, &speed::turning_rad_s(speed_rpm, speed_rad_s)?)
    }
}

#[pymethods]
impl SteadyState {
    /// Return a table with one row for each speed, in C order. Needs pandas.
    ///
    /// Returns
    /// -------
    /// pandas.DataFrame
    ///     One column for each attribute. `attrs["units"]` has their units.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If pandas is not installed: `pip install "./crates/pump-py[dataframe]"`.
    fn to_dataframe<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pumpmodel._results.tables")?.call_method1("steady_dataframe", (slf,))
    }

    /// Return the attributes over the speed. Needs xarray.
    ///
    /// Returns
    /// -------
    /// xarray.Dataset
    ///     One variable for each attribute, of the speeds' shape; speeds of one dimension are the coordinate
    ///     `speed_rpm`. Each has the attributes `units` and `long_name`.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If xarray is not installed: `pip install "./crates/pump-py[xarray]"`.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pumpmodel._results.tables")?.call_method1("steady_xarray", (slf,))
    }

    /// Return the attributes by their names.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Floats or read-only arrays, without a copy.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, numbers) in self.fields() {
            dict.set_item(name, numbers)?;
        }
        Ok(dict)
    }

    fn __eq__(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        for ((name, mine), (_, theirs)) in self.fields().into_iter().zip(other.fields()) {
            if Floats::extract(name, mine.bind(py))? != Floats::extract(name, theirs.bind(py))? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let shown = self
            .fields()
            .into_iter()
            .map(|(name, numbers)| Ok(format!("{name}={}", numbers.bind(py).repr()?)))
            .collect::<PyResult<Vec<_>>>()?;
        Ok(format!("SteadyState({})", shown.join(", ")))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let fields = PyTuple::new(py, self.fields().map(|(_, numbers)| numbers))?;
        Ok((py.get_type::<Self>().getattr("_rebuild")?, fields))
    }

    #[staticmethod]
    #[pyo3(signature = (*fields))]
    fn _rebuild(py: Python<'_>, fields: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let name = "an attribute of a steady state";
        Self::of(py, fields.iter().map(|numbers| Floats::extract(name, numbers)))
    }
}

impl SteadyState {
    /// Computes the steady state at every speed, while other Python threads run.
    fn at(py: Python<'_>, pump: &Pump, speeds_rad_s: &Floats) -> PyResult<Self> {
        let states = States::of(&pump.by_speed);
        let rows = SignalCheck::map(py, speeds_rad_s.values(), |rad_s| {
            states.numbers_at(rad_s).map_err(errors::displacement)
        })?;
        warn_of_cavitation(py, speeds_rad_s, &rows)?;
        let column = |n: usize| match n.checked_sub(1) {
            None => speeds_rad_s.map(py, speed::rpm),
            Some(n) => Ok(speeds_rad_s.with_values(collected(rows.iter().map(|row| row[n]))?)),
        };
        Self::of(py, (0..FIELDS).map(column))
    }

    fn of(py: Python<'_>, fields: impl Iterator<Item = PyResult<Floats>>) -> PyResult<Self> {
        let fields = <[Floats; FIELDS]>::try_from(fields.collect::<PyResult<Vec<_>>>()?)
            .map_err(|_| errors::value("these are not the 10 attributes that a steady state needs"))?;
        let [
            speed,
            inlet_min,
            inlet_max,
            inlet_mean,
            outlet_min,
            outlet_max,
            outlet_mean,
            flow,
            peak_to_peak,
            rms,
        ] = fields;
        Ok(Self {
            speed_rpm: speed.into_frozen(py)?,
            inlet_min_kpa: inlet_min.into_frozen(py)?,
            inlet_max_kpa: inlet_max.into_frozen(py)?,
            inlet_mean_kpa: inlet_mean.into_frozen(py)?,
            outlet_min_kpa: outlet_min.into_frozen(py)?,
            outlet_max_kpa: outlet_max.into_frozen(py)?,
            outlet_mean_kpa: outlet_mean.into_frozen(py)?,
            mean_flow_ml_s: flow.into_frozen(py)?,
            ripple_peak_to_peak: peak_to_peak.into_frozen(py)?,
            ripple_rms: rms.into_frozen(py)?,
        })
    }

    /// Returns the attributes by their names.
    fn fields(&self) -> [(&'static str, &Py<PyAny>); FIELDS] {
        [
            ("speed_rpm", &self.speed_rpm),
            ("inlet_min_kpa", &self.inlet_min_kpa),
            ("inlet_max_kpa", &self.inlet_max_kpa),
            ("inlet_mean_kpa", &self.inlet_mean_kpa),
            ("outlet_min_kpa", &self.outlet_min_kpa),
            ("outlet_max_kpa", &self.outlet_max_kpa),
            ("outlet_mean_kpa", &self.outlet_mean_kpa),
            ("mean_flow_ml_s", &self.mean_flow_ml_s),
            ("ripple_peak_to_peak", &self.ripple_peak_to_peak),
            ("ripple_rms", &self.ripple_rms),
        ]
    }
}

/// Warns once if a pressure is below 0 kPa absolute at a speed.
fn warn_of_cavitation(py: Python<'_>, speeds_rad_s: &Floats, rows: &[[f64; NUMBERS]]) -> PyResult<()> {
    let lowest = |n: usize| collected(rows.iter().map(|row| row[n]));
    let (inlet_kpa, outlet_kpa) = (lowest(INLET_MIN)?, lowest(OUTLET_MIN)?);
    let pressures = Pressures { inlet_kpa: &inlet_kpa, outlet_kpa: &outlet_kpa };
    pressures.warn(py, |n| match speeds_rad_s {
        Floats::One(_) => String::new(),
        Floats::Many { values, .. } => format!(
            " at {} r/min, the lowest of {} of {} speeds below 0",
            Shown((1e6 * speed::rpm(values[n])).round() / 1e6),
            pressures.below(),
            values.len()
        ),
    })
}

/// Steady states of a pump at any speed.
pub(super) struct States<'a> {
    pump: &'a SpeedDependentPump,
    /// The part that the speeds share, where every speed has the same volume.
    shared: Option<SteadyStates<'a>>,
}

impl<'a> States<'a> {
    pub(super) fn of(pump: &'a SpeedDependentPump) -> Self {
        let shared = pump.law().is_none().then(|| pump.base().steady_states());
        Self { pump, shared }
    }

    /// Computes the numbers of a steady state at a speed: its attributes but the speed, in their order.
    pub(super) fn numbers_at(&self, rad_s: f64) -> Result<[f64; NUMBERS], DisplacementError> {
        let report = SteadyReport::from(match &self.shared {
            Some(states) => states.at(rad_s)?,
            None => self.pump.at(rad_s)?.steady_state(rad_s)?,
        });
        Ok([
            report.inlet_min_kpa,
            report.inlet_max_kpa,
            report.inlet_mean_kpa,
            report.outlet_min_kpa,
            report.outlet_max_kpa,
            report.outlet_mean_kpa,
            report.mean_flow_ml_s,
            report.ripple_peak_to_peak,
            report.ripple_rms,
        ])
    }
}
