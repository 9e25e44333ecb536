//! Pumps from names, drawings and plain data, and variations of a pump.

use std::ops::RangeInclusive;

use pump_bench::catalogue::{BoughtPump, DrawnPump, unusual};
use pump_bench::config::Config;
use pump_bench::files::MOST_PUMP_FILE_BYTES;
use pump_bench::head_print;
use pump_bench::pump_file::{HeadTable, LineTable, PumpFile, RollerVolumeTable};
use pump_bench::report::pump_check;
use pump_model::units::radians;
use pump_model::{Geometry, Shown};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyType};

use super::pump::Pump;
use super::volume_fit::{fit_named, points_of};
use crate::argument::{Argument, Items, number, optional, told, told_of, whole};
use crate::line::optional_line;
use crate::python::advice::worded;
use crate::python::errors::{self, value};
use crate::python::plain;
use crate::python::warnings::warn;

/// Volumes of a revolution that a pump file takes, mL.
const ML_PER_REV: RangeInclusive<f64> = 1e-6..=1e5;
/// Most bytes of a pump's id.
const MOST_ID_BYTES: usize = 64;

#[pymethods]
impl Pump {
    /// Return the pump of a file, of a name in the configuration, or a built-in one, as the command's `--pump` does.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Path of a TOML file; or a name in `[pumps]` of the configuration, which `DOSE_CONFIG` or the user's folder
    ///     has; or "three-roller" or "two-roller", each also with "-published" or "-as-built".
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If a file cannot be opened. A missing file is a FileNotFoundError.
    /// PumpFileError
    ///     If no pump has this name, its file or the configuration cannot be used, or another configured name has the
    ///     same record. It is a ValueError too.
    #[staticmethod]
    fn named(py: Python<'_>, name: &str) -> PyResult<Self> {
        let config = Config::of_user(None).map_err(errors::config)?;
        Self::new(config.pump(name).map_err(errors::config)?)?.warning(py)
    }

    /// Return a pump from the dimensions of its drawing, without any measurement.
    ///
    /// Roller volume and engagement angle follow from the drawing. The lines are hoses of the pump's own tube. Motor,
    /// fluid and ambient, which a drawing does not tell, are assumed as `dose pumps new` says.
    ///
    /// Parameters
    /// ----------
    /// id : str
    ///     Name in records: 1 to 64 of a-z, 0-9, - and _.
    /// rollers : int
    ///     Number of rollers.
    /// bore_radius_mm : float
    ///     Inner radius of the tube, mm.
    /// tube_outer_radius_mm : float
    ///     Outer radius of the tube, mm.
    /// backplate_radius_mm : float
    ///     Radius of the backplate, mm.
    /// contact_angle_deg : float
    ///     Contact angle beta, deg: the backplate spans 180 + 2 beta.
    /// roller_radius_mm : float
    ///     Radius of a roller, mm.
    /// roller_offset_mm : float
    ///     Distance from the shaft to a roller's axis, mm.
    /// hose_length_mm : float
    ///     Length of the hose on either side, mm.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the pump cannot work, for example because its rollers leave the tube open.
    ///
    /// Examples
    /// --------
    /// >>> import pumpmodel as pm
    /// >>> pump = pm.Pump.from_drawing(
    /// ...     "bench-2", rollers=3, bore_radius_mm=5, tube_outer_radius_mm=7, backplate_radius_mm=63,
    /// ...     contact_angle_deg=30, roller_radius_mm=20, roller_offset_mm=40, hose_length_mm=331,
    /// ... )
    /// >>> pump.is_estimated
    /// True
    #[staticmethod]
    #[allow(clippy::too_many_arguments, reason = "dimensions of a drawing, each by its name")]
    #[pyo3(signature = (
        id, *, rollers, bore_radius_mm, tube_outer_radius_mm, backplate_radius_mm, contact_angle_deg, roller_radius_mm,
        roller_offset_mm, hose_length_mm
    ))]
    fn from_drawing(
        py: Python<'_>,
        id: &Bound<'_, PyAny>,
        rollers: &Bound<'_, PyAny>,
        bore_radius_mm: &Bound<'_, PyAny>,
        tube_outer_radius_mm: &Bound<'_, PyAny>,
        backplate_radius_mm: &Bound<'_, PyAny>,
        contact_angle_deg: &Bound<'_, PyAny>,
        roller_radius_mm: &Bound<'_, PyAny>,
        roller_offset_mm: &Bound<'_, PyAny>,
        hose_length_mm: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let geometry = Geometry {
            rollers: count(rollers)?,
            bore_radius_mm: number("bore_radius_mm", bore_radius_mm)?,
            tube_outer_radius_mm: number("tube_outer_radius_mm", tube_outer_radius_mm)?,
            backplate_radius_mm: number("backplate_radius_mm", backplate_radius_mm)?,
            contact_angle_rad: radians(number("contact_angle_deg", contact_angle_deg)?),
            roller_radius_mm: number("roller_radius_mm", roller_radius_mm)?,
            roller_offset_mm: number("roller_offset_mm", roller_offset_mm)?,
        };
        let hose_length_mm = number("hose_length_mm", hose_length_mm)?;
        let roller_volume = RollerVolumeTable::Drawing;
        let drawn = DrawnPump { id: told("id", id)?.to_owned(), geometry, hose_length_mm, roller_volume };
        Self::checked(drawn.pump_file().map_err(errors::model)?)?.warning(py)
    }

    /// Return a bought head of which the volume per revolution and the number of rollers are known, and no dimension.
    ///
    /// Whole pitches are exact. Within a pitch a default pulse stands, with a spread that drawings of heads leave. Its
    /// motor, fluid and ambient are assumed as in the built-in pumps, with water at 25 °C and standard pressure.
    ///
    /// Parameters
    /// ----------
    /// id : str
    ///     Name in records: 1 to 64 of a-z, 0-9, - and _.
    /// ml_per_rev : float
    ///     Volume of a revolution, mL.
    /// rollers : int
    ///     Number of rollers.
    /// tube_bore_mm : float, optional
    ///     Diameter of the tube's bore, mm. It tells how far heads of a kind differ.
    /// inlet : Line, optional
    ///     Line from the inlet's reservoir to the pump. Without it pressures are not known.
    /// outlet : Line, optional
    ///     Line from the pump to the outlet's reservoir. Without it pressures and settling are not known.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the pump cannot work, for example because its volume is not positive, or because no head delivers it
    ///     through such a bore.
    ///
    /// Warns
    /// -----
    /// UserWarning
    ///     Of values that are possible and unusual: a volume for its bore, or a number of rollers.
    ///
    /// Examples
    /// --------
    /// >>> import pumpmodel as pm
    /// >>> pump = pm.Pump.from_ml_per_rev("acid", ml_per_rev=0.5, rollers=4)
    /// >>> round(pump.volume_per_revolution_ml, 6), pump.is_estimated
    /// (0.5, True)
    #[staticmethod]
    #[pyo3(signature = (id, *, ml_per_rev, rollers, tube_bore_mm=None, inlet=None, outlet=None))]
    fn from_ml_per_rev(
        py: Python<'_>,
        id: &Bound<'_, PyAny>,
        ml_per_rev: &Bound<'_, PyAny>,
        rollers: &Bound<'_, PyAny>,
        tube_bore_mm: Argument<'_, '_>,
        inlet: Argument<'_, '_>,
        outlet: Argument<'_, '_>,
    ) -> PyResult<Self> {
        let ml_per_rev = number("ml_per_rev", ml_per_rev)?;
        if !ML_PER_REV.contains(&ml_per_rev) {
            let (given, least, most) = (Shown(ml_per_rev), ML_PER_REV.start(), ML_PER_REV.end());
            return Err(value(format_args!("ml_per_rev is {given}; allowed: {least} to {most}")));
        }
        let mut head = HeadTable::new(ml_per_rev);
        head.tube_bore_mm = optional("tube_bore_mm", tube_bore_mm)?;
        let (inlet, outlet) = (optional_line("inlet", inlet)?, optional_line("outlet", outlet)?);
        let mut file =
            BoughtPump { id: told("id", id)?.to_owned(), head, rollers: count(rollers)? }.pump_file();
        file.inlet = inlet.map_or(LineTable::UNKNOWN, |line| LineTable::from(line.get().0));
        file.outlet.line = outlet.map_or(LineTable::UNKNOWN, |line| LineTable::from(line.get().0));
        Self::checked(file)?.warning(py)
    }

    /// Return this pump with some parts replaced. A part that is left out stays.
    ///
    /// Other rollers make another head, whose record is its own: without an `id` its id ends with a number of that
    /// head, and without a `name` its name tells the rollers.
    ///
    /// Parameters
    /// ----------
    /// id : str, optional
    ///     Name in records.
    /// name : str, optional
    ///     Name for people.
    /// rollers : int, optional
    ///     Number of rollers.
    /// inlet : Line, optional
    ///     Line from the inlet's reservoir to the pump.
    /// outlet : Line, optional
    ///     Line from the pump to the outlet's reservoir.
    /// roller_volume : VolumeFit, VolumePolynomial or "drawing", optional
    ///     Volume of a roller from points or a function, from coefficients, or from the pump's dimensions.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the pump cannot work, for example because its rollers leave the tube open.
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    #[pyo3(signature = (*, id=None, name=None, rollers=None, inlet=None, outlet=None, roller_volume=None))]
    fn replace(
        &self,
        py: Python<'_>,
        id: Argument<'_, '_>,
        name: Argument<'_, '_>,
        rollers: Option<&Bound<'_, PyAny>>,
        inlet: Argument<'_, '_>,
        outlet: Argument<'_, '_>,
        roller_volume: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut file = self.file.clone();
        if let Some(rollers) = rollers {
            file = with_rollers(file, count(rollers)?);
        }
        if let Some(id) = id {
            file.pump.id = told("id", id)?.to_owned();
        }
        if let Some(name) = name {
            file.pump.name = told("name", name)?.to_owned();
        }
        if let Some(line) = optional_line("inlet", inlet)? {
            file.inlet = LineTable::from(line.get().0);
        }
        if let Some(line) = optional_line("outlet", outlet)? {
            file.outlet.line = LineTable::from(line.get().0);
        }
        if let Some(volume) = roller_volume {
            file.roller_volume = Some(roller_volume_of(volume)?);
        }
        Self::checked(file)?.warning(py)
    }

    /// Return the pump as plain data: the tables of its pump file.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Numbers, texts, lists and dicts only, under the keys of a pump file.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let json = serde_json::to_string(&self.file)
            .unwrap_or_else(|error| unreachable!("a pump file is plain tables: {error}"));
        py.import("json")?.call_method1("loads", (json,))
    }

    /// Return the pump of the tables that `to_dict` gave, changed or not.
    ///
    /// Parameters
    /// ----------
    /// data : dict
    ///     Tables of a pump file.
    ///
    /// Raises
    /// ------
    /// PumpFileError
    ///     If a key is unknown or missing, or its value is not allowed. It is a ValueError too.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        let file = plain::read(
            "a pump",
            data,
            MOST_PUMP_FILE_BYTES,
            |json| serde_json::from_str::<PumpFile>(json),
            errors::PumpFileError::new_err,
        )?;
        Self::checked(file.with_assumptions())?.warning(data.py())
    }

    /// Check the pump as `dose pumps check` does, and say what it gives.
    ///
    /// Returns
    /// -------
    /// str
    ///     A line each for head, volumes, flows, speeds, motor, fluid, lines and uncertainty, with their units, and for
    ///     each of `warnings`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the pump cannot work.
    fn check(&self) -> PyResult<String> {
        pump_check(&self.file, None).map_err(errors::displacement)
    }

    /// Warnings of values that are possible and unusual, mostly a slip of a unit or a digit, or rollers that overlap in
    /// space. Every way to a pump gives them as Python warnings too.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        worded(&unusual(&self.file))
    }

    /// True if the pump's volumes follow from a drawing, or from a volume per revolution, that no measurement has
    /// confirmed.
    #[getter]
    fn is_estimated(&self) -> bool {
        self.file.is_estimated()
    }

    /// Volume that a roller displaces as it engages, V_r, mL.
    #[getter]
    fn roller_volume_ml(&self) -> f64 {
        self.model().roller_volume().total_ml()
    }

    /// Angle over which a roller engages, phi, rad.
    #[getter]
    fn engagement_rad(&self) -> f64 {
        self.model().roller_volume().engagement_rad()
    }
}

impl Pump {
    /// Checks the tables of a pump that was made here rather than read from a file.
    fn checked(file: PumpFile) -> PyResult<Self> {
        let pump = Self::new(file)?;
        pump.file.check(&pump.file.pump.id).map_err(errors::pump_file)?;
        Ok(pump)
    }

    /// Returns the pump after a warning of each value that is unusual, as rollers that overlap in space.
    pub(super) fn warning(self, py: Python<'_>) -> PyResult<Self> {
        warn(py, &worded(&unusual(&self.file)))?;
        Ok(self)
    }
}

/// Returns the file with another number of rollers, by names of its own.
fn with_rollers(mut file: PumpFile, count: u32) -> PumpFile {
    if file.rollers.count == count {
        return file;
    }
    let ending =
        |file: &PumpFile| (format!("-{:08x}", head_print(file)), format!(", {} rollers", file.rollers.count));
    // A head that was itself made in this way has its ending exchanged.
    let (id, name) = ending(&file);
    if let Some(first) = file.pump.id.strip_suffix(&id) {
        file.pump.id = first.to_owned();
        file.pump.name = file.pump.name.strip_suffix(&name).unwrap_or(&file.pump.name).to_owned();
    }
    file.rollers.count = count;
    let (id, name) = ending(&file);
    file.pump.id.truncate(MOST_ID_BYTES - id.len());
    file.pump.id += &id;
    file.pump.name += &name;
    file
}

/// Reads a number of rollers.
fn count(rollers: &Bound<'_, PyAny>) -> PyResult<u32> {
    whole("rollers", rollers, 1, 1000)
}

/// Reads a roller volume: the word "drawing", a `VolumeFit` or a `VolumePolynomial`.
fn roller_volume_of(volume: &Bound<'_, PyAny>) -> PyResult<RollerVolumeTable> {
    if let Ok(word) = volume.cast::<PyString>() {
        return match word.to_str()? {
            "drawing" => Ok(RollerVolumeTable::Drawing),
            other => Err(value(format_args!(
                "roller_volume is '{other}'; allowed: a VolumeFit, a VolumePolynomial, or 'drawing'"
            ))),
        };
    }
    let refused = || -> PyResult<PyErr> {
        let given = told_of(volume)?;
        let allowed = "roller_volume must be a VolumeFit, a VolumePolynomial or \"drawing\"";
        Ok(PyTypeError::new_err(format!("{allowed}, not {given}")))
    };
    if volume.is_instance_of::<PyType>() {
        return Err(refused()?);
    }
    if let Ok(polynomial) = volume.getattr("_polynomial") {
        let (polynomial_ml_deg, engagement_angle_deg): ([f64; 6], f64) = polynomial.extract()?;
        return Ok(RollerVolumeTable::Polynomial { engagement_angle_deg, polynomial_ml_deg, total_ml: None });
    }
    let Ok(fit) = volume.getattr("_fit") else {
        return Err(refused()?);
    };
    let (method, points): (String, Items<(f64, f64)>) = fit.extract()?;
    Ok(RollerVolumeTable::Measured { fit: fit_named(&method)?, points: points_of(points)? })
}
