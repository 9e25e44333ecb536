//! A pump: the tables of its file, and the model that follows from them.

use std::path::PathBuf;

use pump_bench::built_in;
use pump_bench::displacement::SpeedDependentPump;
use pump_bench::pump_file::PumpFile;
use pump_model::Pump as Model;
use pyo3::prelude::*;

use crate::argument::{choice, object};
use crate::line::Line;
use crate::python::errors::{self, value};

/// Ways to a pump.
const WAYS: &str = "pm.Pump.three_roller() makes one, pm.Pump.named(...) another of its file or its name";

/// Variants of a built-in pump, and the ends of their names.
pub(crate) const VARIANTS: [(&str, &str); 3] =
    [("measured", ""), ("published", "-published"), ("as-built", "-as-built")];

/// A roller pump with its two lines, its motor and its fluid, as a pump file describes them.
///
/// `Pump.three_roller`, `Pump.two_roller`, `Pump.named`, `Pump.from_toml`, `Pump.from_drawing`, `Pump.from_dict` and
/// `Pump.replace` make pumps. Volumes are in mL, pressures in kPa absolute, angles in rad of the pump head. At angle 0
/// a roller begins to leave the outlet.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> pump = pm.Pump.three_roller()
/// >>> round(pump.average_flow_ml_s(speed_rpm=100), 4)
/// 35.5308
#[pyclass(frozen, eq, module = "pumpmodel")]
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pump {
    pub(crate) file: PumpFile,
    /// Model of the pump, with the dependence of its volumes on the speed if the file has one.
    pub(crate) by_speed: SpeedDependentPump,
}

#[pymethods]
impl Pump {
    /// Return the pump of McIntyre et al. with three rollers.
    ///
    /// Parameters
    /// ----------
    /// variant : {"measured", "published", "as-built"}
    ///     "measured" has the paper's dimensions with the measured roller volume of 2.1055 mL, "published" has the
    ///     roller volume of its table, 2.06 mL, and "as-built" has the dimensions of its authors' code.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no variant has this name.
    #[staticmethod]
    #[pyo3(signature = (variant="measured"))]
    fn three_roller(variant: &str) -> PyResult<Self> {
        Self::built_in("three-roller", variant)
    }

    /// Return the pump of McIntyre et al. with two rollers.
    ///
    /// Parameters
    /// ----------
    /// variant : {"measured", "published", "as-built"}
    ///     "measured" has the paper's dimensions with the measured roller volume of 2.1055 mL, "published" has the
    ///     roller volume of its table, 2.06 mL, and "as-built" has the dimensions of its authors' code.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no variant has this name.
    #[staticmethod]
    #[pyo3(signature = (variant="measured"))]
    fn two_roller(variant: &str) -> PyResult<Self> {
        Self::built_in("two-roller", variant)
    }

    /// Read a pump file.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     TOML file with `schema = "pump/1"`.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be opened. A missing file is a FileNotFoundError.
    /// PumpFileError
    ///     If the file is no pump file, or the pump that it describes cannot work. It is a ValueError too.
    #[staticmethod]
    fn from_toml(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::new(PumpFile::read(&path).map_err(errors::pump_file)?)?.warning(py)
    }

    /// Return the pump as the text of a pump file.
    ///
    /// Returns
    /// -------
    /// str
    ///     TOML that `from_toml` reads back as an equal pump.
    fn to_toml(&self) -> String {
        self.file.to_toml()
    }

    /// Name of the pump in records and reports.
    #[getter]
    fn id(&self) -> &str {
        &self.file.pump.id
    }

    /// Name for people.
    #[getter]
    fn name(&self) -> &str {
        &self.file.pump.name
    }

    /// Number of rollers.
    #[getter]
    fn rollers(&self) -> u32 {
        self.file.rollers.count
    }

    /// Angle between rollers, rad: the period of the flow.
    #[getter]
    fn pitch_rad(&self) -> f64 {
        self.model().pitch_rad()
    }

    /// Volume of a revolution, mL.
    #[getter]
    fn volume_per_revolution_ml(&self) -> f64 {
        self.model().revolution_ml()
    }

    /// Line from the inlet's reservoir to the pump.
    #[getter]
    fn inlet(&self) -> Line {
        Line(*self.model().inlet())
    }

    /// Line from the pump to the outlet's reservoir.
    #[getter]
    fn outlet(&self) -> Line {
        Line(*self.model().outlet())
    }

    /// Motor steps per revolution of the pump head, gear included.
    #[getter]
    fn steps_per_rev(&self) -> f64 {
        self.file.limits().motor.steps_per_rev
    }

    /// Fastest speed of the pump head, r/min.
    #[getter]
    fn max_speed_rpm(&self) -> f64 {
        self.file.motor.max_speed_rpm
    }

    /// Largest acceleration of the pump head, rad/s².
    #[getter]
    fn max_acceleration_rad_s2(&self) -> f64 {
        self.file.motor.max_acceleration_rad_s2
    }

    /// Rate of a dose that names no rate, speed or time, mL/s.
    #[getter]
    pub(crate) fn default_rate_ml_s(&self) -> f64 {
        self.file.pump.default_rate_ml_s
    }

    fn __repr__(&self) -> String {
        format!(
            "Pump(id='{}', rollers={}, volume_per_revolution_ml={:.4})",
            self.file.pump.id,
            self.file.rollers.count,
            self.model().revolution_ml()
        )
    }

    pub(crate) fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        // Equal pumps have equal numbers; Python's hash of 0.0 is that of -0.0.
        (self.id(), self.rollers(), self.volume_per_revolution_ml()).into_pyobject(py)?.into_any().hash()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("_rebuild")?, (self.to_toml(),)))
    }

    #[staticmethod]
    fn _rebuild(toml: &str) -> PyResult<Self> {
        Self::new(PumpFile::parse(toml, "of a pickled pump").map_err(errors::pump_file)?)
    }
}

impl Pump {
    /// Builds the model of a pump file.
    pub(crate) fn new(file: PumpFile) -> PyResult<Self> {
        let by_speed = file.speed_dependent_pump().map_err(errors::model)?;
        Ok(Self { file, by_speed })
    }

    /// Returns the model as it is without a dependence on the speed.
    pub(crate) fn model(&self) -> &Model {
        self.by_speed.base()
    }

    fn built_in(name: &str, variant: &str) -> PyResult<Self> {
        let full = format!("{name}{}", choice("variant", variant, &VARIANTS)?);
        let file = built_in(&full).ok_or_else(|| value(format_args!("no built-in pump is `{full}`")))?;
        Self::new(file)
    }
}

/// Reads the pump of the argument `pump`.
///
/// # Errors
///
/// `TypeError` for anything else, with the ways to a pump.
pub(crate) fn pump_given(given: &Bound<'_, PyAny>) -> PyResult<Py<Pump>> {
    object("pump", "Pump", WAYS, given)
}
