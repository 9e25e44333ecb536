//! The cruise of a dose, given as `rate`, `speed` or `within`.

use pump_bench::units;
use pump_ctl::plan::Cruise;
use pyo3::prelude::*;

use super::quantity::quantity;
use crate::python::errors::value;

/// Reads the one of the three that is given; none leaves the pump file's default rate.
pub(crate) fn cruise(
    rate: Option<&Bound<'_, PyAny>>,
    speed: Option<&Bound<'_, PyAny>>,
    within: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<Cruise>> {
    match (rate, speed, within) {
        (None, None, None) => Ok(None),
        (Some(rate), None, None) => Ok(Some(quantity("rate", "10 mL/s", rate, units::rate)?)),
        (None, Some(speed), None) => {
            let rad_s = quantity("speed", "100rpm", speed, units::speed_rad_s)?;
            Ok(Some(Cruise::Speed { rad_s }))
        }
        (None, None, Some(within)) => {
            let time_s = quantity("within", "10s", within, units::time_s)?;
            Ok(Some(Cruise::Within { time_s }))
        }
        _ => Err(value("rate, speed and within exclude each other; give one at most")),
    }
}
