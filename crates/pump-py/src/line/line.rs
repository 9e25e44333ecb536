//! The hydraulic line of one port.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::python::errors;

/// Hydraulic line between the rollers and a reservoir: compliance at the pump, resistance and inertance in series.
///
/// Parameters
/// ----------
/// resistance_kpa_s_ml : float
///     R, kPa s/mL, zero or more.
/// compliance_ml_kpa : float
///     C, mL/kPa, more than zero.
/// inertance_kpa_s2_ml : float
///     L, kPa s²/mL, more than zero.
/// reservoir_kpa : float
///     Pressure of the reservoir, kPa absolute, more than zero.
///
/// Raises
/// ------
/// ValueError
///     If a value is outside its range.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> line = pm.Line(
/// ...     resistance_kpa_s_ml=0.1108, compliance_ml_kpa=0.0361, inertance_kpa_s2_ml=0.0042, reservoir_kpa=88.637
/// ... )
/// >>> line == pm.Pump.three_roller().outlet
/// True
#[pyclass(frozen, eq, module = "pumpmodel")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line(pub(crate) pump_model::Line);

#[pymethods]
impl Line {
    #[new]
    #[pyo3(signature = (*, resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml, reservoir_kpa))]
    fn new(
        resistance_kpa_s_ml: f64,
        compliance_ml_kpa: f64,
        inertance_kpa_s2_ml: f64,
        reservoir_kpa: f64,
    ) -> PyResult<Self> {
        let line =
            pump_model::Line { resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml, reservoir_kpa };
        line.validate().map_err(errors::model)?;
        Ok(Self(line))
    }

    /// Resistance R, kPa s/mL.
    #[getter]
    fn resistance_kpa_s_ml(&self) -> f64 {
        self.0.resistance_kpa_s_ml
    }

    /// Compliance C, mL/kPa.
    #[getter]
    fn compliance_ml_kpa(&self) -> f64 {
        self.0.compliance_ml_kpa
    }

    /// Inertance L, kPa s²/mL.
    #[getter]
    fn inertance_kpa_s2_ml(&self) -> f64 {
        self.0.inertance_kpa_s2_ml
    }

    /// Pressure of the reservoir, kPa absolute.
    #[getter]
    fn reservoir_kpa(&self) -> f64 {
        self.0.reservoir_kpa
    }

    /// Return this line with some values replaced. A value that is left out stays.
    ///
    /// Parameters
    /// ----------
    /// resistance_kpa_s_ml : float, optional
    ///     R, kPa s/mL, zero or more.
    /// compliance_ml_kpa : float, optional
    ///     C, mL/kPa, more than zero.
    /// inertance_kpa_s2_ml : float, optional
    ///     L, kPa s²/mL, more than zero.
    /// reservoir_kpa : float, optional
    ///     Pressure of the reservoir, kPa absolute, more than zero.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is outside its range.
    #[pyo3(signature = (
        *, resistance_kpa_s_ml=None, compliance_ml_kpa=None, inertance_kpa_s2_ml=None, reservoir_kpa=None
    ))]
    fn replace(
        &self,
        resistance_kpa_s_ml: Option<f64>,
        compliance_ml_kpa: Option<f64>,
        inertance_kpa_s2_ml: Option<f64>,
        reservoir_kpa: Option<f64>,
    ) -> PyResult<Self> {
        let [resistance, compliance, inertance, reservoir] = self.numbers();
        Self::new(
            resistance_kpa_s_ml.unwrap_or(resistance),
            compliance_ml_kpa.unwrap_or(compliance),
            inertance_kpa_s2_ml.unwrap_or(inertance),
            reservoir_kpa.unwrap_or(reservoir),
        )
    }

    /// Return the line as plain data.
    ///
    /// Returns
    /// -------
    /// dict
    ///     The four floats of the line by their names. `Line(**...)` reads them back.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(slf.py());
        let names = ["resistance_kpa_s_ml", "compliance_ml_kpa", "inertance_kpa_s2_ml", "reservoir_kpa"];
        for (name, number) in names.into_iter().zip(slf.get().numbers()) {
            dict.set_item(name, number)?;
        }
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        let [resistance, compliance, inertance, reservoir] = self.numbers();
        format!(
            "Line(resistance_kpa_s_ml={resistance:?}, compliance_ml_kpa={compliance:?}, \
             inertance_kpa_s2_ml={inertance:?}, reservoir_kpa={reservoir:?})"
        )
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        PyTuple::new(py, self.numbers())?.hash()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let numbers = PyTuple::new(py, self.numbers())?;
        Ok((py.get_type::<Self>().getattr("_rebuild")?, numbers))
    }

    #[staticmethod]
    fn _rebuild(resistance: f64, compliance: f64, inertance: f64, reservoir: f64) -> PyResult<Self> {
        Self::new(resistance, compliance, inertance, reservoir)
    }
}

impl Line {
    fn numbers(&self) -> [f64; 4] {
        let line = &self.0;
        [line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml, line.reservoir_kpa]
    }
}
