//! Weighed runs and readings of a scale or a vessel.

use pump_bench::calibration::{CalibrationRun, Expected, Fit};
use pump_bench::pump_file::PumpFile;
use pump_bench::units;
use pump_bench::units::Amount;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::argument::{quantity, told_of, word};
use crate::python::errors::value;

/// Reads the standard uncertainty of a reading.
pub(crate) fn scale_of(scale: &Bound<'_, PyAny>) -> PyResult<Amount> {
    let amount = quantity("scale", "0.01g", scale, units::amount)?;
    if matches!(amount, Amount::Mass(part) | Amount::Volume(part) if part < 0.0) {
        return Err(value(
            "scale is negative; allowed: the standard uncertainty of a reading, 0 or more, as \"0.01g\"",
        ));
    }
    Ok(amount)
}

/// Reads the standard uncertainty of a reading of the file's fluid, mL; 0 if it is not given.
pub(crate) fn reading_ml(scale: Option<&Bound<'_, PyAny>>, file: &PumpFile) -> PyResult<f64> {
    let amount = scale.map(scale_of).transpose()?;
    Ok(amount.map_or(0.0, |amount| amount.volume_ml(file.fluid.density_kg_m3)))
}

/// Returns the scatter that is expected of runs: with the standard uncertainty that `scale` states for a reading, or
/// else with that of the finest digit of the readings.
pub(crate) fn expected_of(
    scale: Option<&Bound<'_, PyAny>>,
    file: &PumpFile,
    runs: &[CalibrationRun],
) -> PyResult<Expected> {
    match scale {
        Some(_) => Ok(Expected::of(file, reading_ml(scale, file)?)),
        None => Ok(Expected::of_runs(file, runs)),
    }
}

/// Reads the reading of a scale, g, or of a vessel, mL.
#[pyfunction]
pub(crate) fn _reading(reading: &Bound<'_, PyAny>) -> PyResult<(Option<f64>, Option<f64>)> {
    let amount = quantity("reading", "42.51g", reading, units::amount)?;
    Ok(match amount {
        Amount::Mass(mass_g) => (Some(mass_g), None),
        Amount::Volume(volume_ml) => (None, Some(volume_ml)),
    })
}

/// Converts `WeighedRun`s to runs.
pub(crate) fn runs_of(runs: &Bound<'_, PyAny>) -> PyResult<Vec<CalibrationRun>> {
    let Ok(runs) = runs.try_iter() else {
        return Err(PyTypeError::new_err(format!(
            "runs must be a sequence of WeighedRuns, not {}",
            told_of(runs)?
        )));
    };
    runs.map(|run| {
        let run = run?;
        let json = run.getattr("_json").ok().filter(|_| !run.is_instance_of::<PyType>());
        let Some(json) = json else {
            return Err(PyTypeError::new_err(format!("runs must be WeighedRuns, not {}", told_of(&run)?)));
        };
        let json: String = json.call0()?.extract()?;
        serde_json::from_str(&json)
            .map_err(|error| value(format_args!("these are not the data of a weighed run: {error}")))
    })
    .collect()
}

/// Reads the curve that is fitted to weighed runs.
pub(crate) fn fit_named(fit: &str) -> PyResult<Fit> {
    word("fit", fit, Fit::ALL)
}
