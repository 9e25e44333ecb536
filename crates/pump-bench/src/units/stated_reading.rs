//! The reading of a scale or a vessel, as a person writes it down: its last digit tells its resolution.

use super::amount::{Amount, amount_of};
use super::error::QuantityError;
use super::kind::Kind;
use super::reading::{QuantityText, shown};

/// Reading of a scale or of a measuring vessel, with the step of its last digit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedReading {
    /// Mass or volume that was read.
    pub amount: Amount,
    /// Mass or volume of one step of the last digit: 0.1 g for `23.8g`.
    pub resolution: Amount,
}

/// Reads what a scale or a vessel showed: `23.8g`, `23.80 g`, `24mL`.
///
/// ```
/// use pump_bench::units::{Amount, stated_reading};
///
/// assert_eq!(stated_reading("24mL")?.resolution, Amount::Volume(1.0));
/// let Amount::Mass(grams) = stated_reading("23.80 g")?.resolution else { panic!() };
/// assert!((grams - 0.01).abs() < 1e-12);
/// assert!(stated_reading("-3g").is_err());
/// # Ok::<(), pump_bench::units::QuantityError>(())
/// ```
///
/// # Errors
/// Returns the [`QuantityError`] of a text that is neither a volume nor a mass, or that is not positive.
pub fn stated_reading(text: &str) -> Result<StatedReading, QuantityError> {
    let read = amount_of(text, Kind::Reading)?;
    let (Amount::Mass(value) | Amount::Volume(value)) = read;
    if value < 0.0 {
        let allowed = "more than 0: write what arrived in the vessel, without sign";
        return Err(QuantityError::OutOfRange { text: shown(text.trim()), allowed });
    }
    let number = QuantityText::new(text, Kind::Mass)?.number;
    let step = value / number.parse::<f64>().unwrap_or(1.0) * last_digit(&number);
    let resolution = match read {
        Amount::Mass(_) => Amount::Mass(step),
        Amount::Volume(_) => Amount::Volume(step),
    };
    Ok(StatedReading { amount: read, resolution })
}

/// Returns the step of the last digit of a number: 0.01 for `1.25`, 100 for `1.2e3`.
pub(crate) fn last_digit(number: &str) -> f64 {
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    let exponent: i32 = exponent.parse().unwrap_or(0);
    libm::pow(10.0, f64::from(exponent) - decimals as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_digit_tells_the_resolution() {
        for (text, step) in
            [("23.8g", 0.1), ("23.80g", 0.01), ("24g", 1.0), ("1.2e2g", 10.0), ("0.0238kg", 0.1)]
        {
            let Amount::Mass(found) = stated_reading(text).unwrap().resolution else { panic!("{text}") };
            assert!((found / step - 1.0).abs() < 1e-9, "{text}: {found}");
        }
        assert_eq!(stated_reading("500uL").unwrap().resolution, Amount::Volume(1e-3));
    }

    #[test]
    fn what_is_no_reading_is_refused_with_the_value() {
        for text in ["23.8", "g", "-3g", "0g", "23.8 furlong", "nang"] {
            assert!(stated_reading(text).is_err(), "{text}");
        }
        let unitless = stated_reading("23.8").unwrap_err().to_string();
        assert!(unitless.starts_with("`23.8` has no unit; write for example 25g or 25mL"), "{unitless}");
        assert!(stated_reading("-3g").unwrap_err().to_string().contains("-3g"));
    }
}
