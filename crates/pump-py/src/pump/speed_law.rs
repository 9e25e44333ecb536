//! Computations behind `pumpmodel.SpeedLaw`.

use pump_model::{ModelError, Pump as Model, SpeedLaw};
use pyo3::prelude::*;

use super::pump::Pump;
use crate::argument::{Argument, speed};
use crate::python::{SignalCheck, errors};

/// Parameters of a speed law: s, D (1/kPa), theta_c (rad), P_atm (kPa).
type LawNumbers = (f64, f64, f64, f64);

fn law_of(numbers: LawNumbers) -> PyResult<SpeedLaw> {
    let (scale, distensibility_per_kpa, closure_rad, ambient_kpa) = numbers;
    let law = SpeedLaw { scale, distensibility_per_kpa, closure_rad, ambient_kpa };
    law.validate().map_err(errors::model)?;
    Ok(law)
}

/// Returns the law fitted to the numbers that McIntyre et al. publish.
#[pyfunction]
pub(crate) fn _law_published() -> LawNumbers {
    let SpeedLaw { scale, distensibility_per_kpa, closure_rad, ambient_kpa } = SpeedLaw::PUBLISHED;
    (scale, distensibility_per_kpa, closure_rad, ambient_kpa)
}

/// Refuses parameters that no speed law has.
#[pyfunction]
pub(crate) fn _law_check(law: LawNumbers) -> PyResult<()> {
    law_of(law).map(drop)
}

/// Returns the volume of a revolution at a speed, mL.
#[pyfunction]
#[pyo3(signature = (law, pump, speed_rpm, speed_rad_s))]
pub(crate) fn _law_revolution<'py>(
    py: Python<'py>,
    law: LawNumbers,
    pump: &Pump,
    speed_rpm: Argument<'_, 'py>,
    speed_rad_s: Argument<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    over(py, law, pump, speed_rpm, speed_rad_s, SpeedLaw::revolution_ml)
}

/// Returns the pressure at which a segment of tube is trapped at a speed, kPa absolute.
#[pyfunction]
#[pyo3(signature = (law, pump, speed_rpm, speed_rad_s))]
pub(crate) fn _law_trapped<'py>(
    py: Python<'py>,
    law: LawNumbers,
    pump: &Pump,
    speed_rpm: Argument<'_, 'py>,
    speed_rad_s: Argument<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    over(py, law, pump, speed_rpm, speed_rad_s, SpeedLaw::trapped_kpa)
}

/// Applies a property of the law to each speed, while other Python threads run.
fn over<'py>(
    py: Python<'py>,
    law: LawNumbers,
    pump: &Pump,
    speed_rpm: Argument<'_, 'py>,
    speed_rad_s: Argument<'_, 'py>,
    of: fn(&SpeedLaw, &Model, f64) -> Result<f64, ModelError>,
) -> PyResult<Bound<'py, PyAny>> {
    let law = law_of(law)?;
    let speeds = speed::turning_rad_s(speed_rpm, speed_rad_s)?;
    let numbers =
        SignalCheck::map(py, speeds.values(), |rad_s| of(&law, pump.model(), rad_s).map_err(errors::model))?;
    speeds.with_values(numbers).into_object(py)
}
