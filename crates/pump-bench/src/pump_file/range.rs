//! Ranges of the values in a pump file. Each check words its own refusal.

use std::fmt::Display;
use std::ops::RangeInclusive;

use pump_model::Shown;

use super::error::PumpFileError;

/// A value that a pump file must not hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct WrongValue {
    key: &'static str,
    value: String,
    allowed: String,
}

impl WrongValue {
    /// Returns the refusal of a key that is missing.
    pub(super) fn missing(key: &'static str, allowed: &str) -> Self {
        Self { key, value: "missing".to_owned(), allowed: allowed.to_owned() }
    }

    /// Adds a hint in brackets to the allowed range.
    pub(super) fn hint(mut self, hint: &str) -> Self {
        self.allowed += &format!(" ({hint})");
        self
    }

    /// Returns the key, its value in words, and what is allowed.
    #[cfg(feature = "klipper")]
    pub(crate) fn parts(self) -> (&'static str, String, String) {
        (self.key, self.value, self.allowed)
    }

    /// Returns the error of the pump file that `origin` names.
    pub(super) fn in_file(self, origin: &str) -> PumpFileError {
        let Self { key, value, allowed } = self;
        PumpFileError::Value { origin: origin.to_owned(), key, value, allowed }
    }
}

/// Refuses a value unless `ok` is true; `allowed` says which values are.
pub(super) fn allow(
    ok: bool,
    key: &'static str,
    value: impl Display,
    allowed: &str,
) -> Result<(), WrongValue> {
    if ok {
        return Ok(());
    }
    let text = value.to_string();
    // A number of hundreds of digits is as readable with an exponent.
    let value =
        if text.len() > 24 { text.parse().map_or(text, |number| Shown(number).to_string()) } else { text };
    Err(WrongValue { key, value, allowed: allowed.to_owned() })
}

/// Refuses a value outside `range`.
pub(super) fn within<T: PartialOrd + Display>(
    key: &'static str,
    value: T,
    range: RangeInclusive<T>,
) -> Result<(), WrongValue> {
    let allowed = format!("{} to {}", range.start(), range.end());
    allow(range.contains(&value), key, value, &allowed)
}

/// Refuses a value outside `range` if a value is given.
pub(super) fn within_if_given(
    key: &'static str,
    value: Option<f64>,
    range: RangeInclusive<f64>,
) -> Result<(), WrongValue> {
    value.map_or(Ok(()), |value| within(key, value, range))
}

/// Refuses a value that is not positive and finite.
pub(super) fn positive(key: &'static str, value: f64) -> Result<(), WrongValue> {
    allow(value > 0.0 && value.is_finite(), key, value, "more than 0")
}

/// Refuses a value that is not positive or exceeds `most`.
pub(super) fn positive_up_to(key: &'static str, value: f64, most: f64) -> Result<(), WrongValue> {
    allow(value > 0.0 && value <= most, key, value, &format!("more than 0, {most} at most"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_names_key_value_and_range() {
        let said = |checked: Result<(), WrongValue>| checked.unwrap_err().in_file("a file").to_string();
        assert_eq!(
            said(within("[fluid] vapour_kpa", -0.5, 0.0..=1e4).map_err(|wrong| wrong.hint("absolute"))),
            "pump file a file: [fluid] vapour_kpa is -0.5; allowed: 0 to 10000 (absolute)"
        );
        assert!(
            said(within("[motor] gear", f64::NAN, 1e-3..=1e4)).ends_with("is NaN; allowed: 0.001 to 10000")
        );
        assert!(said(positive("[tube] life_ml", f64::INFINITY)).ends_with("is inf; allowed: more than 0"));
        assert!(
            said(positive_up_to("[tube] life_ml", 3.0, 2.0)).ends_with("allowed: more than 0, 2 at most")
        );
        assert_eq!(within_if_given("[tube] poisson_ratio", None, 0.0..=0.5), Ok(()));
    }
}
