//! Pressure limits of a dose.

use pump_ctl::Parameter;
use pump_ctl::plan::{PlanError, PressureLimits};
use pump_model::Shown;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::argument::{Argument, optional};
use crate::python::errors;

/// Pressure limits that a dose must keep. A limit that is left out is the pump file's, if it has one.
///
/// In reverse the outlet limit applies to the inlet, which then pushes, and the inlet limit to the outlet.
///
/// Parameters
/// ----------
/// max_outlet_kpa : float, optional
///     Largest pressure at the port that pushes, kPa absolute, 1e-9 to 1e6.
/// min_inlet_kpa : float, optional
///     Smallest pressure at the port that sucks, kPa absolute, up to 1e6 either way.
///
/// Raises
/// ------
/// ValueError
///     If a limit is outside its range.
#[pyclass(frozen, eq, get_all, module = "pumpmodel")]
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Limits {
    /// Largest pressure at the port that pushes, kPa absolute, or None.
    pub(crate) max_outlet_kpa: Option<f64>,
    /// Smallest pressure at the port that sucks, kPa absolute, or None.
    pub(crate) min_inlet_kpa: Option<f64>,
}

#[pymethods]
impl Limits {
    #[new]
    #[pyo3(signature = (*, max_outlet_kpa=None, min_inlet_kpa=None))]
    fn new(max_outlet_kpa: Argument<'_, '_>, min_inlet_kpa: Argument<'_, '_>) -> PyResult<Self> {
        let max_outlet_kpa = optional("max_outlet_kpa", max_outlet_kpa)?;
        let limits = Self { max_outlet_kpa, min_inlet_kpa: optional("min_inlet_kpa", min_inlet_kpa)? };
        limits.pressures().validate().map_err(named)?;
        Ok(limits)
    }

    /// Return the limits as plain data.
    ///
    /// Returns
    /// -------
    /// dict
    ///     `max_outlet_kpa` and `min_inlet_kpa`, floats or None. `Limits(**...)` reads them back.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(slf.py());
        dict.set_item("max_outlet_kpa", slf.get().max_outlet_kpa)?;
        dict.set_item("min_inlet_kpa", slf.get().min_inlet_kpa)?;
        Ok(dict)
    }

    pub(crate) fn __repr__(&self) -> String {
        let shown = |limit: Option<f64>| limit.map_or("None".to_owned(), |kpa| format!("{kpa:?}"));
        format!(
            "Limits(max_outlet_kpa={}, min_inlet_kpa={})",
            shown(self.max_outlet_kpa),
            shown(self.min_inlet_kpa)
        )
    }

    pub(crate) fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        PyTuple::new(py, [self.max_outlet_kpa, self.min_inlet_kpa])?.hash()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let numbers = PyTuple::new(py, [self.max_outlet_kpa, self.min_inlet_kpa])?;
        Ok((py.get_type::<Self>().getattr("_rebuild")?, numbers))
    }

    #[staticmethod]
    #[pyo3(signature = (max_outlet_kpa, min_inlet_kpa))]
    fn _rebuild(max_outlet_kpa: Option<f64>, min_inlet_kpa: Option<f64>) -> Self {
        Self { max_outlet_kpa, min_inlet_kpa }
    }
}

impl Limits {
    /// Returns the limits as the planner takes them.
    pub(crate) fn pressures(&self) -> PressureLimits {
        PressureLimits { max_outlet_kpa: self.max_outlet_kpa, min_inlet_kpa: self.min_inlet_kpa }
    }
}

/// Maps a refusal of a limit, in the words of the arguments.
fn named(error: PlanError) -> PyErr {
    let PlanError::OutOfRange { parameter, value, allowed } = error else { return errors::plan(error) };
    let name = match parameter {
        Parameter::OutletLimit => "max_outlet_kpa",
        Parameter::InletLimit => "min_inlet_kpa",
        _ => return errors::plan(error),
    };
    errors::value(format_args!("{name} is {}; allowed: {allowed}", Shown(value)))
}
