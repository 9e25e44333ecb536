//! A calibration: the factor of a pump's volume that weighed runs show, and its uncertainty.

use std::path::PathBuf;

use pump_bench::calibration::{
    Calibration as DoseCalibration, CalibrationRun, Displacement, Source, Stored, runs_of_csv,
};
use pump_bench::files::{MOST_TABLE_BYTES, read_text};
use pump_bench::pump_file::PumpFile;
use pump_model::units::radians;
use pump_model::{ModelError, Pump as Model};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::weighed::{expected_of, fit_named, runs_of};
use crate::argument::{Argument, Floats, speed, told_of, whole};
use crate::pump::{Pump, pump_given};
use crate::python::SignalCheck;
use crate::python::errors::{self, value};
use crate::python::plain;

/// Volume that a pump really displaces, from weighed runs, with its uncertainty.
///
/// `Calibration.from_runs`, `Calibration.from_csv`, `Bench.calibrate` and `Bench.calibrations` make calibrations. A
/// dose's volume is the model's volume times `displacement_factor`: measured over model volume, which may change with
/// the speed. `version` is the calibration's number on a bench, or 0 without a bench.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> pump = pm.Pump.three_roller()
/// >>> runs = [pm.WeighedRun(speed_rpm=60, turned_deg=720, volume_ml=v) for v in (43.0, 43.1, 43.05)]
/// >>> calibration = pm.Calibration.from_runs(pump, runs)
/// >>> round(calibration.displacement_factor(speed_rpm=60), 4)
/// 1.0097
/// >>> pm.Doser(pump, calibration=calibration).plan("25mL", speed="60rpm").steps < pm.Doser(pump).plan("25mL").steps
/// True
#[pyclass(frozen, eq, module = "pumpmodel")]
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Calibration(pub(crate) Stored);

#[pymethods]
impl Calibration {
    /// Calibrate a pump by weighed runs.
    ///
    /// Parameters
    /// ----------
    /// pump : Pump
    ///     Pump whose fluid was weighed.
    /// runs : sequence of WeighedRun
    ///     Runs with their readings.
    /// scale : str, optional
    ///     Standard uncertainty of a reading, as "0.01g" or "0.1mL".
    /// fit : {"best", "line", "factor", "speed-law"}
    ///     "best" fits a straight line over the speed, or a parabola where an F test at four speeds or more asks for
    ///     it. "line" fits a straight line alone, "factor" one factor for every speed. "speed-law" fits s and D of
    ///     the speed law to three speeds or more.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there are no runs, or a run is impossible.
    #[staticmethod]
    #[pyo3(signature = (pump, runs, *, scale=None, fit="best"))]
    fn from_runs(
        #[pyo3(from_py_with = pump_given)] pump: Py<Pump>,
        runs: &Bound<'_, PyAny>,
        scale: Option<&Bound<'_, PyAny>>,
        fit: &str,
    ) -> PyResult<Self> {
        Self::of(&pump.get().file, runs_of(runs)?, fit, scale)
    }

    /// Calibrate a pump by a table of weighed runs, as `dose calibrate run --from` reads it.
    ///
    /// Parameters
    /// ----------
    /// pump : Pump
    ///     Pump whose fluid was weighed.
    /// path : str or os.PathLike
    ///     CSV with a header. Columns are `speed_rpm`, one of `turned_deg`, `revolutions` and `steps`, and one of
    ///     `mass_g` and `volume_ml`; optional are `start_angle_deg`, `direction`, `temperature_degc` and `time`.
    /// scale : str, optional
    ///     Standard uncertainty of a reading, as "0.01g" or "0.1mL".
    /// fit : {"best", "line", "factor", "speed-law"}
    ///     "best" fits a straight line over the speed, or a parabola where an F test at four speeds or more asks for
    ///     it. "line" fits a straight line alone, "factor" one factor for every speed. "speed-law" fits s and D of
    ///     the speed law to three speeds or more.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be read.
    /// ValueError
    ///     If the file is no such table, or a run is impossible.
    #[staticmethod]
    #[pyo3(signature = (pump, path, *, scale=None, fit="best"))]
    fn from_csv(
        #[pyo3(from_py_with = pump_given)] pump: Py<Pump>,
        path: PathBuf,
        scale: Option<&Bound<'_, PyAny>>,
        fit: &str,
    ) -> PyResult<Self> {
        let text = read_text(&path, MOST_TABLE_BYTES).map_err(|error| errors::file(&path, &error))?;
        let runs = runs_of_csv(&text, pump.get().file.limits().motor.steps_per_rev);
        let runs = runs.map_err(|error| value(format_args!("{}: {error}", path.display())))?;
        Self::of(&pump.get().file, runs, fit, scale)
    }

    /// Return measured over model volume at a cruise speed.
    ///
    /// Parameters
    /// ----------
    /// speed_rpm : float or array_like
    ///     Cruise speed of the pump head, r/min.
    /// speed_rad_s : float or array_like
    ///     Cruise speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    /// pump : Pump, optional
    ///     Pump, which a fitted speed law needs to compute the trapped volume.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     Factor; 1 while only the zero was sought. Array input gives an array of float64 of its shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one speed is given, or if a speed law was fitted and no pump is given.
    #[pyo3(signature = (*, speed_rpm=None, speed_rad_s=None, pump=None))]
    fn displacement_factor<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
        pump: Option<&Pump>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let speeds = speed::speeds_rad_s(speed_rpm, speed_rad_s)?;
        self.over(py, &speeds, pump, 1.0, Displacement::factor_at)?.into_object(py)
    }

    /// Return the standard uncertainty of `displacement_factor`.
    ///
    /// It is widened so that twice its value covers 95 % for any number of runs, and includes the lack of fit.
    ///
    /// Parameters
    /// ----------
    /// speed_rpm : float or array_like
    ///     Cruise speed of the pump head, r/min.
    /// speed_rad_s : float or array_like
    ///     Cruise speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    /// pump : Pump, optional
    ///     Pump, which a fitted speed law needs to compute the trapped volume.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     Standard uncertainty; 0 while only the zero was sought. Array input gives an array of float64 of its shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one speed is given, or if a speed law was fitted and no pump is given.
    #[pyo3(signature = (*, speed_rpm=None, speed_rad_s=None, pump=None))]
    fn standard_uncertainty<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
        pump: Option<&Pump>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let speeds = speed::speeds_rad_s(speed_rpm, speed_rad_s)?;
        self.over(py, &speeds, pump, 0.0, Displacement::whole_standard_at)?.into_object(py)
    }

    /// Number of the calibration on its bench; 0 without a bench.
    #[getter]
    fn version(&self) -> u32 {
        self.0.version
    }

    /// Time at which the calibration was made, UTC.
    #[getter]
    fn date(&self) -> &str {
        &self.0.calibration.date
    }

    /// Name of the fluid that was weighed.
    #[getter]
    fn fluid(&self) -> &str {
        &self.0.calibration.fluid
    }

    /// Mean temperature of that fluid, °C.
    #[getter]
    fn temperature_degc(&self) -> f64 {
        self.0.calibration.temperature_degc
    }

    /// Name that the user gave the tube, or None.
    #[getter]
    fn tube(&self) -> Option<&str> {
        self.0.calibration.tube.as_deref()
    }

    /// Note of the user, or None.
    #[getter]
    fn note(&self) -> Option<&str> {
        self.0.calibration.note.as_deref()
    }

    /// Model volume of a revolution that the factors multiply, mL.
    #[getter]
    fn revolution_ml(&self) -> f64 {
        self.0.calibration.revolution_ml
    }

    /// Speeds of the runs, r/min, rising.
    #[getter]
    fn speeds_rpm(&self) -> Vec<f64> {
        self.displacement().map_or(Vec::new(), |displacement| displacement.speeds_rpm.clone())
    }

    /// Standard deviation of the runs about the fit, as a fraction of the volume; None if there were too few runs.
    #[getter]
    fn scatter(&self) -> Option<f64> {
        self.displacement()?.scatter.standard()
    }

    /// Numbers, from 1, of runs that lie far from the others. The fit includes them.
    #[getter]
    fn outliers(&self) -> Vec<usize> {
        self.displacement().map_or(Vec::new(), |displacement| displacement.outliers.clone())
    }

    /// Model angle of the rollers at the record's angle 0, rad.
    #[getter]
    fn zero_rad(&self) -> f64 {
        self.0.calibration.zero_rad()
    }

    /// Roller volume V_r that short doses found and its standard uncertainty, mL; None if the pump's own holds.
    #[getter]
    fn roller_volume_ml(&self) -> Option<(f64, f64)> {
        self.0.calibration.pulse.map(|pulse| (pulse.roller_volume_ml, pulse.roller_volume_standard_ml))
    }

    /// Engagement angle phi that short doses found and its standard uncertainty, rad; None if the pump's own holds.
    #[getter]
    fn engagement_rad(&self) -> Option<(f64, f64)> {
        let pulse = self.0.calibration.pulse?;
        Some((radians(pulse.engagement_deg), radians(pulse.engagement_standard_deg)))
    }

    /// Return the calibration as plain data, as `dose calibrate list --format json` prints it.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Numbers, texts, lists and dicts only, raw data included.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.call_method1("loads", (self.json(),))
    }

    /// Return the calibration of the data that `to_dict` gave.
    ///
    /// Parameters
    /// ----------
    /// data : dict
    ///     Data that `to_dict` returned. Numbers and arrays of NumPy are taken too.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If `data` is no dict, or holds something that is no plain data.
    /// ValueError
    ///     If the data are no calibration, or a number is none that weighed runs give. The message has the key.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        let Ok(data) = data.cast::<PyDict>() else {
            return Err(PyTypeError::new_err(format!("data must be a dict, not {}", told_of(data)?)));
        };
        let data = data.copy()?;
        let version = data.get_item("version")?.ok_or_else(|| {
            value(
                "these are not the data of a calibration: version is missing; allowed: 0 or a bench's number",
            )
        })?;
        let version = whole("version", &version, 0, u32::MAX.into())?;
        data.del_item("version")?;
        let parse = |json: &str| serde_json::from_str::<DoseCalibration>(json);
        let calibration = plain::read("a calibration", &data, MOST_TABLE_BYTES, parse, value)?;
        Self::checked(version, calibration)
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        (self.0.version, self.date(), self.revolution_ml()).into_pyobject(py)?.into_any().hash()
    }

    fn __repr__(&self) -> String {
        let factor = self.displacement().map_or("none".to_owned(), |displacement| {
            format!("{:.5} at {:.4} r/min", displacement.factor, displacement.reference_rpm)
        });
        let (runs, zero) = (self.0.calibration.runs.len(), self.zero_rad());
        format!(
            "<Calibration {} of {}: factor {factor}, {runs} runs, zero_rad {zero:.5}>",
            self.version(),
            self.date()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("_rebuild")?, (self.json(),)))
    }

    #[staticmethod]
    fn _rebuild(json: &str) -> PyResult<Self> {
        let none = |error: &dyn std::fmt::Display| {
            value(format_args!("these are not the data of a calibration: {error}"))
        };
        let mut data: serde_json::Value = serde_json::from_str(json).map_err(|error| none(&error))?;
        let version = data.as_object_mut().and_then(|data| data.remove("version"));
        let version =
            version.and_then(|version| version.as_u64()).and_then(|version| version.try_into().ok());
        let version = version.ok_or_else(|| none(&"`version` must be a whole number"))?;
        Self::checked(version, serde_json::from_value(data).map_err(|error| none(&error))?)
    }
}

impl Calibration {
    /// Refuses numbers that weighed runs do not give.
    fn checked(version: u32, calibration: DoseCalibration) -> PyResult<Self> {
        let checked = calibration.check();
        checked.map_err(|error| {
            value(format_args!("these are not the data of a calibration: {error}; to_dict() gives such data"))
        })?;
        Ok(Self(Stored::new(version, calibration)))
    }

    /// Fits runs to a pump.
    fn of(
        file: &PumpFile,
        runs: Vec<CalibrationRun>,
        fit: &str,
        scale: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let fit = fit_named(fit)?;
        let expected = expected_of(scale, file, &runs)?;
        let calibration = DoseCalibration::of_runs(file, Source::File, runs, fit, &expected, None);
        Ok(Self(Stored::new(0, calibration.map_err(errors::calibration)?)))
    }

    fn json(&self) -> String {
        serde_json::to_string(&self.0)
            .unwrap_or_else(|error| unreachable!("a calibration is plain data: {error}"))
    }

    fn displacement(&self) -> Option<&Displacement> {
        self.0.calibration.displacement.as_ref()
    }

    /// Evaluates a property of the displacement at speeds in rad/s; returns `without` where no displacement was fitted.
    fn over(
        &self,
        py: Python<'_>,
        speeds: &Floats,
        pump: Option<&Pump>,
        without: f64,
        of: fn(&Displacement, &Model, f64) -> Result<f64, ModelError>,
    ) -> PyResult<Floats> {
        let Some(displacement) = self.displacement() else { return speeds.map(py, |_| without) };
        let line = Model::three_roller();
        let base = match pump {
            Some(pump) => pump.model(),
            None if displacement.law.is_some() => {
                return Err(value("the calibration fitted a speed law, which needs the pump; give pump="));
            }
            // A straight line does not depend on the pump.
            None => &line,
        };
        let factor = |rad_s| of(displacement, base, speed::rpm(rad_s)).map_err(errors::model);
        Ok(speeds.with_values(SignalCheck::map(py, speeds.values(), factor)?))
    }
}
