//! Pressures, absolute or gauge.

use super::error::QuantityError;
use super::kind::Kind;
use super::reading::{QuantityText, shown};

/// A pressure with its reference, vacuum or ambient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pressure {
    /// Pressure in kPa above vacuum.
    Absolute(f64),
    /// Pressure in kPa above ambient.
    Gauge(f64),
}

impl Pressure {
    /// Returns the pressure in kPa absolute, at an ambient pressure in kPa absolute.
    pub fn absolute_kpa(self, ambient_kpa: f64) -> f64 {
        match self {
            Self::Absolute(kpa) => kpa,
            Self::Gauge(kpa) => kpa + ambient_kpa,
        }
    }
}

/// Reads a pressure: `120kPaa`, `20kPag`, `1.2bara`, `15psig`.
///
/// # Errors
/// [`QuantityError::AbsoluteOrGauge`] for a bare `15psi`; it suggests both readings. Otherwise the error of a
/// text that is no pressure.
pub fn pressure(text: &str) -> Result<Pressure, QuantityError> {
    let read = QuantityText::new(text, Kind::Pressure)?;
    if Kind::Pressure.factor(&read.unit).is_some() {
        let (number, unit) = (read.number.clone(), read.unit.clone());
        return Err(QuantityError::AbsoluteOrGauge { text: shown(text), number, unit });
    }
    for (suffix, of) in [('a', Pressure::Absolute as fn(f64) -> Pressure), ('g', Pressure::Gauge)] {
        if let Some(unit) = read.unit.strip_suffix(suffix)
            && Kind::Pressure.factor(unit).is_some()
        {
            return Ok(of(QuantityText { unit: unit.to_owned(), ..read }.value()?));
        }
    }
    Err(read.unknown_unit())
}
