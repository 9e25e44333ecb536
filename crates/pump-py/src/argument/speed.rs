//! Speeds of the pump head, given as `speed_rpm` or `speed_rad_s`.

use pump_model::units::TURN_RAD;
use pyo3::prelude::*;

use super::floats::Floats;
use crate::python::errors::value;

/// Fastest speed that is accepted, rad/s, as in `pump_bench::simulation::Simulation`.
pub(crate) const MAX_SPEED_RAD_S: f64 = 1e4;

/// Speed of one revolution a minute, rad/s. In this order of operations `speed_rpm=100` gives the bits of the
/// command's `--speed 100rpm`.
pub(crate) const RAD_S_PER_RPM: f64 = TURN_RAD / 60.0;

/// An argument that may be left out.
pub(crate) type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Reads the one of both that is given: one speed or many, rad/s.
pub(crate) fn speeds_rad_s(speed_rpm: Argument<'_, '_>, speed_rad_s: Argument<'_, '_>) -> PyResult<Floats> {
    match (speed_rpm, speed_rad_s) {
        (Some(given), None) => {
            let rpm = Floats::read("speed_rpm", given, (MAX_SPEED_RAD_S / RAD_S_PER_RPM).floor())?;
            let py = given.py();
            rpm.map(py, |rpm| rpm * RAD_S_PER_RPM)
        }
        (None, Some(rad_s)) => Floats::read("speed_rad_s", rad_s, MAX_SPEED_RAD_S),
        (None, None) => Err(value("no speed is given; give speed_rpm or speed_rad_s")),
        (Some(_), Some(_)) => Err(value("speed_rpm and speed_rad_s are both given; give exactly one")),
    }
}

/// Returns the name of the one of both that is given, and the rad/s of its unit.
pub(crate) fn given(speed_rpm: Argument<'_, '_>) -> (&'static str, f64) {
    if speed_rpm.is_some() { ("speed_rpm", RAD_S_PER_RPM) } else { ("speed_rad_s", 1.0) }
}

/// Reads the one of both that is given: one speed or many, rad/s, none of them 0.
pub(crate) fn turning_rad_s(speed_rpm: Argument<'_, '_>, speed_rad_s: Argument<'_, '_>) -> PyResult<Floats> {
    let speeds = speeds_rad_s(speed_rpm, speed_rad_s)?;
    if speeds.values().contains(&0.0) {
        let (name, _) = given(speed_rpm);
        return Err(value(format_args!("{name} is 0; allowed: a finite speed other than 0")));
    }
    Ok(speeds)
}

/// Reads a single speed, rad/s, where an array makes no sense. The pump turns.
pub(crate) fn speed_rad_s(speed_rpm: Argument<'_, '_>, speed_rad_s: Argument<'_, '_>) -> PyResult<f64> {
    match turning_rad_s(speed_rpm, speed_rad_s)? {
        Floats::One(speed) => Ok(speed),
        Floats::Many { shape, .. } => {
            let (name, _) = given(speed_rpm);
            Err(value(format_args!("{name} is an array of shape {shape:?}; allowed: one number")))
        }
    }
}

/// Returns a speed, rad/s, if it is finite and not too fast.
pub(crate) fn within(rad_s: f64) -> Option<f64> {
    (-MAX_SPEED_RAD_S..=MAX_SPEED_RAD_S).contains(&rad_s).then_some(rad_s)
}

/// Converts a speed from rad/s to r/min.
pub(crate) fn rpm(rad_s: f64) -> f64 {
    rad_s / RAD_S_PER_RPM
}
