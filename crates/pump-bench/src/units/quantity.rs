//! Quantities that are one number: volume, flow, speed, time, angle, temperature, length and current.

use pump_model::units::TURN_RAD;

use super::error::QuantityError;
use super::kind::Kind;
use super::reading::{QuantityText, shown};

/// Reads a positive volume and returns it in mL.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no positive volume.
pub fn volume_ml(text: &str) -> Result<f64, QuantityError> {
    positive(text, Kind::Volume)
}

/// Reads the life of a tube that is a positive volume, and returns it in mL. Its error names the units of every life.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no positive volume.
pub fn life_ml(text: &str) -> Result<f64, QuantityError> {
    positive(text, Kind::Life)
}

/// Reads a positive flow and returns it in mL/s.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no positive flow.
pub fn flow_ml_s(text: &str) -> Result<f64, QuantityError> {
    positive(text, Kind::Flow)
}

/// Reads a positive speed of the pump head and returns it in rad/s.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no positive speed.
pub fn speed_rad_s(text: &str) -> Result<f64, QuantityError> {
    positive(text, Kind::Speed)
}

/// Reads a positive time and returns it in s.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no positive time.
pub fn time_s(text: &str) -> Result<f64, QuantityError> {
    positive(text, Kind::Time)
}

/// Reads an instant, a time since a beginning that may be zero, and returns it in s.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no time, or a negative one.
pub fn instant_s(text: &str) -> Result<f64, QuantityError> {
    let value = QuantityText::new(text, Kind::Time)?.value()?;
    let negative = || QuantityError::OutOfRange { text: shown(text), allowed: "a time, 0s or later" };
    if value < 0.0 { Err(negative()) } else { Ok(value) }
}

/// Reads an angle, which may be zero or negative, and returns it in rad.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no angle.
pub fn angle_rad(text: &str) -> Result<f64, QuantityError> {
    QuantityText::new(text, Kind::Angle)?.value()
}

/// Reads the angle of a rotor, from one turn back to one turn forward, and returns it in rad.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no angle, or an angle beyond one turn.
pub fn rotor_angle_rad(text: &str) -> Result<f64, QuantityError> {
    let angle_rad = angle_rad(text)?;
    if angle_rad.abs() <= TURN_RAD {
        return Ok(angle_rad);
    }
    Err(QuantityError::OutOfRange {
        text: shown(text),
        allowed: "an angle within one turn, -360deg to 360deg",
    })
}

/// Reads a temperature, which may be zero or negative, and returns it in °C.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no temperature.
pub fn temperature_degc(text: &str) -> Result<f64, QuantityError> {
    QuantityText::new(text, Kind::Temperature)?.value()
}

/// Reads a positive length and returns it in mm.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no positive length.
pub fn length_mm(text: &str) -> Result<f64, QuantityError> {
    positive(text, Kind::Length)
}

/// Reads a height or an altitude, which may be zero or negative, and returns it in mm. A zero needs no unit.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no length.
pub fn height_mm(text: &str) -> Result<f64, QuantityError> {
    if text.trim() == "0" {
        return Ok(0.0);
    }
    QuantityText::new(text, Kind::Length)?.value()
}

/// Reads a positive current and returns it in A.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no positive current.
pub fn current_a(text: &str) -> Result<f64, QuantityError> {
    positive(text, Kind::Current)
}

/// Reads a positive quantity of this kind.
fn positive(text: &str, kind: Kind) -> Result<f64, QuantityError> {
    let value = QuantityText::new(text, kind)?.value()?;
    if value == 0.0 {
        Err(QuantityError::Zero { text: shown(text), kind })
    } else if value < 0.0 {
        Err(QuantityError::Negative { text: shown(text), kind })
    } else {
        Ok(value)
    }
}
