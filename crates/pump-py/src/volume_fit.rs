//! What `pumpmodel.VolumeFit` computes: a roller volume from measured points.

use std::fs;
use std::path::PathBuf;

use pump_bench::catalogue::RollerRuns;
use pump_bench::pump_file::Fit;
use pump_model::VolumePoint;
use pyo3::prelude::*;

use crate::errors::{self, value};
use crate::floats::Floats;

/// Two angles, deg, and a volume, mL.
type Fall = (f64, f64, f64);
/// phi (deg), V_r (mL), residuals and their RMS (mL), falls (None of more than 25 angles), stretches held (deg).
type FitNumbers = (f64, f64, Vec<f64>, f64, Option<Vec<Fall>>, Vec<(f64, f64)>);

/// Fits points and says how well.
#[pyfunction]
pub(crate) fn _volume_fit(method: &str, points: Vec<(f64, f64)>) -> PyResult<FitNumbers> {
    let points = points_of(points);
    let fit = fit_named(method)?.of(&points).map_err(errors::model)?;
    let curve = fit.curve();
    Ok((
        curve.engagement_deg(),
        curve.total_ml(),
        fit.residuals_ml().collect(),
        fit.rms_ml(),
        fit.falls().ok().map(Iterator::collect),
        fit.held_deg().collect(),
    ))
}

/// Volume displaced over the angle since first contact, mL.
#[pyfunction]
pub(crate) fn _volume_fit_at<'py>(
    method: &str,
    points: Vec<(f64, f64)>,
    angle_rad: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let points = points_of(points);
    let fit = fit_named(method)?.of(&points).map_err(errors::model)?;
    let angles = Floats::read("angle_rad", angle_rad, 1e9)?;
    angles.map(|angle| fit.curve().at(angle)).into_object(angle_rad.py())
}

/// Run, angle (deg) and volume (mL) of each row of a table as `dose pumps new` reads it.
#[pyfunction]
pub(crate) fn _volume_runs(path: PathBuf) -> PyResult<Vec<(String, f64, f64)>> {
    let text = fs::read_to_string(&path).map_err(|error| errors::file(&path, &error))?;
    let runs =
        RollerRuns::of_csv(&text).map_err(|error| value(format_args!("{}: {error}", path.display())))?;
    Ok(runs.points().map(|(run, point)| (run.to_owned(), point.angle_deg, point.volume_ml)).collect())
}

/// Run, two angles (deg) and by how much the volume falls between them (mL).
#[pyfunction]
pub(crate) fn _volume_run_falls(runs: Vec<String>, points: Vec<(f64, f64)>) -> Vec<(String, f64, f64, f64)> {
    let runs = RollerRuns::new(runs.into_iter().zip(points_of(points)));
    runs.falls().into_iter().map(|fall| (fall.run, fall.from_deg, fall.to_deg, fall.fall_ml)).collect()
}

pub(crate) fn points_of(points: Vec<(f64, f64)>) -> Vec<VolumePoint> {
    points.into_iter().map(|(angle_deg, volume_ml)| VolumePoint { angle_deg, volume_ml }).collect()
}

pub(crate) fn fit_named(method: &str) -> PyResult<Fit> {
    match method {
        "spline" => Ok(Fit::Spline),
        "quintic" => Ok(Fit::Quintic),
        _ => Err(value(format_args!("method is '{method}'; allowed: 'spline', 'quintic'"))),
    }
}
