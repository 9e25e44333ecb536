//! The amount of a dose: a volume or a mass.

use super::error::QuantityError;
use super::kind::Kind;
use super::reading::{QuantityText, shown};

/// Largest mass that is read as a dose, in g. Grams are what a scale under a vessel shows, and `kg` is easily typed in
/// their place.
const MOST_G: f64 = 10_000.0;

/// The amount of a dose, as a volume or as a mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// Volume in mL. Not zero; negative in reverse.
    Volume(f64),
    /// Mass in g. Not zero; negative in reverse.
    Mass(f64),
}

impl Amount {
    /// Returns the volume in mL of a fluid with this density in kg/m³. A mass is taken as the true mass.
    ///
    /// The reading of a balance in air is about a part in a thousand less than the true mass.
    /// `Weighing::amount_ml` of the calibrations converts it.
    ///
    /// ```
    /// use pump_bench::units::{Amount, amount};
    /// assert_eq!(amount("25mL")?.volume_ml(997.0), 25.0);
    /// assert!((amount("25 g")?.volume_ml(997.0) - 25.0752).abs() < 1e-4);
    /// # Ok::<(), pump_bench::units::QuantityError>(())
    /// ```
    pub fn volume_ml(self, density_kg_m3: f64) -> f64 {
        match self {
            Self::Volume(ml) => ml,
            Self::Mass(grams) => grams * 1e3 / density_kg_m3,
        }
    }
}

/// Reads a volume or a mass that is not zero: `25mL`, `-5mL`, `0.025 L`, `1e3uL`, `25 g`.
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is neither a volume nor a mass, or that is zero.
pub fn amount(text: &str) -> Result<Amount, QuantityError> {
    amount_of(text, Kind::Amount)
}

/// Reads a volume or a mass of a kind that takes both.
pub(super) fn amount_of(text: &str, kind: Kind) -> Result<Amount, QuantityError> {
    let read = QuantityText::new(text, kind)?;
    let is_mass = Kind::Mass.factor(&read.unit).is_some();
    let value = read.value()?;
    if value == 0.0 {
        let kind = if is_mass { Kind::Mass } else { Kind::Volume };
        return Err(QuantityError::Zero { text: shown(text), kind });
    }
    Ok(if is_mass { Amount::Mass(value) } else { Amount::Volume(value) })
}

/// Reads the amount of a dose: an [`amount`] whose mass is 10 kg at most, either way.
///
/// ```
/// use pump_bench::units::dose_amount;
/// assert!(dose_amount("10kg").is_ok() && dose_amount("25L").is_ok());
/// assert!(dose_amount("25kg").unwrap_err().to_string().contains("10 kg at most"));
/// ```
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is no [`amount`], or a larger mass.
pub fn dose_amount(text: &str) -> Result<Amount, QuantityError> {
    match amount(text)? {
        Amount::Mass(grams) if grams.abs() > MOST_G => {
            let allowed = "a mass of 10 kg at most; if more is meant, give the volume, as 25L";
            Err(QuantityError::OutOfRange { text: shown(text), allowed })
        }
        amount => Ok(amount),
    }
}
