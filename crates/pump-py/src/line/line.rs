//! The hydraulic line of one port.

use pump_model::{ModelError, Parameter, Shown};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::argument::{Argument, number, object, optional};
use crate::python::errors;

/// Ways to a line.
const WAYS: &str = "hose.line(fluid, reservoir_kpa=..., flow_ml_s=...) makes the line of a hose, pm.Line(...) one of \
                    R, C and L";

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
        resistance_kpa_s_ml: &Bound<'_, PyAny>,
        compliance_ml_kpa: &Bound<'_, PyAny>,
        inertance_kpa_s2_ml: &Bound<'_, PyAny>,
        reservoir_kpa: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        Self::of([
            number("resistance_kpa_s_ml", resistance_kpa_s_ml)?,
            number("compliance_ml_kpa", compliance_ml_kpa)?,
            number("inertance_kpa_s2_ml", inertance_kpa_s2_ml)?,
            number("reservoir_kpa", reservoir_kpa)?,
        ])
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
        resistance_kpa_s_ml: Argument<'_, '_>,
        compliance_ml_kpa: Argument<'_, '_>,
        inertance_kpa_s2_ml: Argument<'_, '_>,
        reservoir_kpa: Argument<'_, '_>,
    ) -> PyResult<Self> {
        let [resistance, compliance, inertance, reservoir] = self.numbers();
        Self::of([
            optional("resistance_kpa_s_ml", resistance_kpa_s_ml)?.unwrap_or(resistance),
            optional("compliance_ml_kpa", compliance_ml_kpa)?.unwrap_or(compliance),
            optional("inertance_kpa_s2_ml", inertance_kpa_s2_ml)?.unwrap_or(inertance),
            optional("reservoir_kpa", reservoir_kpa)?.unwrap_or(reservoir),
        ])
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
        Self::of([resistance, compliance, inertance, reservoir])
    }
}

impl Line {
    /// Makes the line of R, C, L and the reservoir's pressure.
    fn of(numbers: [f64; 4]) -> PyResult<Self> {
        let [resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml, reservoir_kpa] = numbers;
        let line =
            pump_model::Line { resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml, reservoir_kpa };
        line.validate().map_err(named)?;
        Ok(Self(line))
    }

    fn numbers(&self) -> [f64; 4] {
        let line = &self.0;
        [line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml, line.reservoir_kpa]
    }
}

/// Maps a refusal of a line, in the words of the arguments.
pub(crate) fn named(error: ModelError) -> PyErr {
    let ModelError::OutOfRange { parameter, value, allowed } = error else { return errors::model(error) };
    let name = match parameter {
        Parameter::LineResistance => "resistance_kpa_s_ml",
        Parameter::LineCompliance => "compliance_ml_kpa",
        Parameter::LineInertance => "inertance_kpa_s2_ml",
        Parameter::ReservoirPressure => "reservoir_kpa",
        _ => return errors::model(error),
    };
    errors::value(format_args!("{name} is {}; allowed: {allowed}", Shown(value)))
}

/// Reads the line of the argument `name` if it is given.
///
/// # Errors
///
/// `TypeError` for anything else, with the ways to a line.
pub(crate) fn optional_line(name: &str, given: Argument<'_, '_>) -> PyResult<Option<Py<Line>>> {
    given.map(|given| object(name, "Line", WAYS, given)).transpose()
}
