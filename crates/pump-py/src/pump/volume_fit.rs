//! Computations behind `pumpmodel.VolumeFit`: a roller volume from measured points.

use std::path::PathBuf;

use pump_bench::catalogue::RollerRuns;
use pump_bench::files::{MOST_TABLE_BYTES, read_text};
use pump_bench::pump_file::CurveFit;
use pump_model::units::degrees;
use pump_model::{ModelError, RollerVolume, VolumePoint};
use pyo3::prelude::*;

use crate::argument::{Floats, Items, word};
use crate::python::collected;
use crate::python::errors::{self, value};

/// A fall of the volume: from and to angle, deg, and by how much, mL.
type FallNumbers = (f64, f64, f64);
/// Numbers of a fit: phi (deg), V_r (mL), residuals and their RMS (mL), falls (None beyond 25 angles), stretches held
/// (deg).
type FitNumbers = (f64, f64, Vec<f64>, f64, Option<Vec<FallNumbers>>, Vec<(f64, f64)>);

/// Fits points, and reports the residuals of the fit.
#[pyfunction]
pub(crate) fn _volume_fit(method: &str, points: Items<(f64, f64)>) -> PyResult<FitNumbers> {
    let points = points_of(points)?;
    let fit = fit_named(method)?.of(&points).map_err(|error| match error {
        ModelError::TooFewPoints { angles, needed } => value(format_args!(
            "angle_deg has {angles} different angles; allowed: {needed} or more for the method '{method}'; measure at \
             more angles, or describe the curve by VolumeFit.from_function or VolumePolynomial"
        )),
        error => errors::model(error),
    })?;
    let curve = fit.curve();
    Ok((
        curve.engagement_deg(),
        curve.total_ml(),
        collected(points.iter().zip(fit.residuals_ml()).map(|(_, residual_ml)| residual_ml))?,
        fit.rms_ml(),
        fit.falls().ok().map(Iterator::collect),
        fit.held_deg().collect(),
    ))
}

/// Returns the volume displaced at an angle since first contact, mL.
#[pyfunction]
pub(crate) fn _volume_fit_at<'py>(
    method: &str,
    points: Items<(f64, f64)>,
    angle_rad: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let points = points_of(points)?;
    let fit = fit_named(method)?.of(&points).map_err(errors::model)?;
    let angles = Floats::read("angle_rad", angle_rad, 1e9)?;
    let py = angle_rad.py();
    angles.map(py, |angle| fit.curve().at(angle))?.into_object(py)
}

/// Returns run, angle (deg) and volume (mL) of each row of a table that `dose pumps new` reads.
#[pyfunction]
pub(crate) fn _volume_runs(path: PathBuf) -> PyResult<Vec<(String, f64, f64)>> {
    let text = read_text(&path, MOST_TABLE_BYTES).map_err(|error| errors::file(&path, &error))?;
    let runs =
        RollerRuns::of_csv(&text).map_err(|error| value(format_args!("{}: {error}", path.display())))?;
    Ok(runs.points().map(|(run, point)| (run.to_owned(), point.angle_deg, point.volume_ml)).collect())
}

/// Returns each fall within a run: its run, from and to angle (deg), and by how much the volume falls (mL).
#[pyfunction]
pub(crate) fn _volume_run_falls(
    runs: Items<String>,
    points: Items<(f64, f64)>,
) -> PyResult<Vec<(String, f64, f64, f64)>> {
    let runs = RollerRuns::new(runs.0.into_iter().zip(points_of(points)?));
    collected(runs.falls().into_iter().map(|fall| (fall.run, fall.from_deg, fall.to_deg, fall.fall_ml)))
}

/// Returns V_r (mL) of a polynomial, and the stretches over which its volume is held (deg).
#[pyfunction]
pub(crate) fn _volume_polynomial(
    highest_first: [f64; 6],
    engagement_deg: f64,
) -> PyResult<(f64, Vec<(f64, f64)>)> {
    let curve = RollerVolume::from_polynomial_deg(highest_first, engagement_deg).map_err(errors::model)?;
    let held_deg = curve.held_rad().map(|(from, to)| (degrees(from), degrees(to))).collect();
    Ok((curve.total_ml(), held_deg))
}

/// Returns the volume that a polynomial has displaced at an angle since first contact, mL.
#[pyfunction]
pub(crate) fn _volume_polynomial_at<'py>(
    highest_first: [f64; 6],
    engagement_deg: f64,
    angle_rad: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let curve = RollerVolume::from_polynomial_deg(highest_first, engagement_deg).map_err(errors::model)?;
    let angles = Floats::read("angle_rad", angle_rad, 1e9)?;
    angles.map(angle_rad.py(), |angle| curve.at(angle))?.into_object(angle_rad.py())
}

/// Converts pairs of angle (deg) and volume (mL) to points.
pub(crate) fn points_of(points: Items<(f64, f64)>) -> PyResult<Vec<VolumePoint>> {
    collected(points.0.into_iter().map(|(angle_deg, volume_ml)| VolumePoint { angle_deg, volume_ml }))
}

/// Reads how points are fitted.
pub(crate) fn fit_named(method: &str) -> PyResult<CurveFit> {
    word("method", method, CurveFit::ALL)
}
