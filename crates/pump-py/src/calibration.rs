//! A calibration: what was weighed, and what it makes of a dose.

use std::path::PathBuf;

use pump_bench::calibration::{
    Calibration as DoseCalibration, Displacement, Expected, Fit, Run, Source, Stored, runs_of_csv,
};
use pump_bench::pump_file::PumpFile;
use pump_bench::units;
use pump_bench::units::Amount;
use pump_model::{ModelError, Pump as Model};
use pyo3::prelude::*;

use crate::doser::text;
use crate::errors::{self, value};
use crate::floats::Floats;
use crate::pump::{Pump, one_of};
use crate::speed::{self, Argument};

/// What a pump really displaces, from runs that were weighed, and how sure that is.
///
/// Made by `Calibration.from_runs`, `Calibration.from_csv`, `Bench.calibrate` and `Bench.calibrations`. Volumes are the
/// model's times `displacement_factor`, measured over model volume, which may change with the speed. `version` is its number
/// on a bench, 0 if it is of none.
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
    /// The calibration of a pump by weighed runs.
    ///
    /// Parameters
    /// ----------
    /// pump : Pump
    ///     The pump, whose fluid was weighed.
    /// runs : sequence of WeighedRun
    ///     The runs.
    /// scale : str, optional
    ///     Standard uncertainty of a reading, as "0.01g" or "0.1mL".
    /// fit : str
    ///     "line", a straight line over the speed, or "speed-law", s and D of the speed law, from three speeds or more.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there are no runs, or one of them cannot be right.
    #[staticmethod]
    #[pyo3(signature = (pump, runs, *, scale=None, fit="line"))]
    fn from_runs(
        pump: &Pump,
        runs: &Bound<'_, PyAny>,
        scale: Option<&Bound<'_, PyAny>>,
        fit: &str,
    ) -> PyResult<Self> {
        Self::of(&pump.file, runs_of(runs)?, fit, scale)
    }

    /// The same of a table of runs, as `dose calibrate run --from` reads it.
    ///
    /// Parameters
    /// ----------
    /// pump : Pump
    ///     The pump, whose fluid was weighed.
    /// path : str or os.PathLike
    ///     CSV with a header: `speed_rpm`, one of `turned_deg`, `revolutions`, `steps`, one of `mass_g`, `volume_ml`, and
    ///     perhaps `start_angle_deg`, `direction`, `temperature_degc`, `time`.
    /// scale : str, optional
    ///     Standard uncertainty of a reading, as "0.01g" or "0.1mL".
    /// fit : str
    ///     "line", a straight line over the speed, or "speed-law", s and D of the speed law, from three speeds or more.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If it cannot be read.
    /// ValueError
    ///     If it is no such table, or a run cannot be right.
    #[staticmethod]
    #[pyo3(signature = (pump, path, *, scale=None, fit="line"))]
    fn from_csv(pump: &Pump, path: PathBuf, scale: Option<&Bound<'_, PyAny>>, fit: &str) -> PyResult<Self> {
        let text = std::fs::read_to_string(&path).map_err(|error| errors::file(&path, &error))?;
        let runs = runs_of_csv(&text, pump.file.limits().motor.steps_per_rev);
        let runs = runs.map_err(|error| value(format_args!("{}: {error}", path.display())))?;
        Self::of(&pump.file, runs, fit, scale)
    }

    /// Measured over model volume.
    ///
    /// Parameters
    /// ----------
    /// speed_rpm : float or array_like
    ///     Cruise speed of the pump head, r/min.
    /// speed_rad_s : float or array_like
    ///     The same in rad/s; exactly one of both is given.
    /// pump : Pump, optional
    ///     The pump, which a fitted speed law needs: it says what traps how much.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     The factor; of arrays an array of float64 of the same shape. 1 while only the zero was sought.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one speed is given, or a speed law was fitted and no pump is given.
    #[pyo3(signature = (*, speed_rpm=None, speed_rad_s=None, pump=None))]
    fn displacement_factor<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
        pump: Option<&Pump>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let speeds = speed::speeds_rad_s(speed_rpm, speed_rad_s)?;
        self.over(&speeds, pump, 1.0, Displacement::factor_at)?.into_object(py)
    }

    /// Standard uncertainty of `displacement_factor`, widened so that twice it covers 95 % whatever the number of runs.
    ///
    /// Parameters, returns and errors are those of `displacement_factor`; 0 while only the zero was sought.
    #[pyo3(signature = (*, speed_rpm=None, speed_rad_s=None, pump=None))]
    fn standard_uncertainty<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
        pump: Option<&Pump>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let speeds = speed::speeds_rad_s(speed_rpm, speed_rad_s)?;
        self.over(&speeds, pump, 0.0, Displacement::standard_at)?.into_object(py)
    }

    /// Its number on its bench; 0 if it is of none.
    #[getter]
    fn version(&self) -> u32 {
        self.0.version
    }

    /// When it was made, UTC.
    #[getter]
    fn date(&self) -> &str {
        &self.0.calibration.date
    }

    /// The tube, as the user calls it.
    #[getter]
    fn tube(&self) -> Option<&str> {
        self.0.calibration.tube.as_deref()
    }

    /// What the user wants remembered.
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

    /// Standard deviation of the runs about the line, part of the volume; None if there were too few.
    #[getter]
    fn scatter(&self) -> Option<f64> {
        self.displacement()?.scatter.standard()
    }

    /// Numbers of the runs, from 1, that lie far from the others; they are in the fit.
    #[getter]
    fn outliers(&self) -> Vec<usize> {
        self.displacement().map_or(Vec::new(), |displacement| displacement.outliers.clone())
    }

    /// Model angle of the rollers where the record says 0, rad.
    #[getter]
    fn zero_rad(&self) -> f64 {
        self.0.calibration.zero_rad()
    }

    /// The calibration as plain data, as `dose calibrate list --format json` prints it.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Numbers, texts, lists and dicts alone; raw data included.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.call_method1("loads", (self.json(),))
    }

    /// The calibration of what `to_dict` gave.
    ///
    /// Parameters
    /// ----------
    /// data : dict
    ///     What `to_dict` returned.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If it is no calibration.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        Self::_rebuild(&data.py().import("json")?.call_method1("dumps", (data,))?.extract::<String>()?)
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
        let calibration: DoseCalibration = serde_json::from_value(data).map_err(|error| none(&error))?;
        calibration.check_schema().map_err(|error| none(&error))?;
        Ok(Self(Stored { version, calibration }))
    }
}

impl Calibration {
    fn of(file: &PumpFile, runs: Vec<Run>, fit: &str, scale: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let fit = fit_named(fit)?;
        let expected = Expected::of(file, reading_ml(scale, file)?);
        let calibration = DoseCalibration::of_runs(file, Source::File, runs, fit, &expected, None);
        Ok(Self(Stored { version: 0, calibration: calibration.map_err(errors::calibration)? }))
    }

    fn json(&self) -> String {
        serde_json::to_string(&self.0)
            .unwrap_or_else(|error| unreachable!("a calibration is plain data: {error}"))
    }

    fn displacement(&self) -> Option<&Displacement> {
        self.0.calibration.displacement.as_ref()
    }

    /// A property of the displacement over speeds in rad/s; `without` where there is none.
    fn over(
        &self,
        speeds: &Floats,
        pump: Option<&Pump>,
        without: f64,
        of: fn(&Displacement, &Model, f64) -> Result<f64, ModelError>,
    ) -> PyResult<Floats> {
        let Some(displacement) = self.displacement() else { return Ok(speeds.map(|_| without)) };
        let line = Model::three_roller();
        let base = match pump {
            Some(pump) => &pump.model,
            None if displacement.speed_law.is_some() => {
                return Err(value("a speed law was fitted, which needs the pump: give pump="));
            }
            // A line is the same on every pump.
            None => &line,
        };
        let numbers = speeds.values().iter().map(|rad_s| of(displacement, base, speed::rpm(*rad_s)));
        let numbers = numbers.collect::<Result<Vec<_>, _>>().map_err(errors::model)?;
        Ok(speeds.with_values(numbers))
    }
}

/// Standard uncertainty of a reading, mL.
pub(crate) fn reading_ml(scale: Option<&Bound<'_, PyAny>>, file: &PumpFile) -> PyResult<f64> {
    let Some(scale) = scale else { return Ok(0.0) };
    let amount = units::amount(text("scale", "0.01g", scale)?).map_err(value)?;
    let reading_ml = amount.volume_ml(file.fluid.density_kg_m3);
    if reading_ml < 0.0 {
        return Err(value("scale is negative; write how unsure a reading is, as \"0.01g\""));
    }
    Ok(reading_ml)
}

/// What scale or vessel showed: g, or mL.
#[pyfunction]
pub(crate) fn _reading(reading: &Bound<'_, PyAny>) -> PyResult<(Option<f64>, Option<f64>)> {
    let amount = units::amount(text("reading", "42.51g", reading)?).map_err(value)?;
    Ok(match amount {
        Amount::Mass(mass_g) => (Some(mass_g), None),
        Amount::Volume(volume_ml) => (None, Some(volume_ml)),
    })
}

/// Runs from `WeighedRun`s.
pub(crate) fn runs_of(runs: &Bound<'_, PyAny>) -> PyResult<Vec<Run>> {
    runs.try_iter()?
        .map(|run| {
            let json: String = run?.call_method0("_json")?.extract()?;
            serde_json::from_str(&json).map_err(|error| value(format_args!("a run is none: {error}")))
        })
        .collect()
}

/// What is fitted to weighed runs.
pub(crate) fn fit_named(fit: &str) -> PyResult<Fit> {
    one_of("fit", fit, &["line", "speed-law"])?;
    Ok(if fit == "line" { Fit::Line } else { Fit::SpeedLaw })
}
