//! Texts split into a number and a unit.

use super::error::QuantityError;
use super::kind::Kind;

/// A number and a unit that are not yet converted.
pub(super) struct QuantityText {
    pub(super) text: String,
    pub(super) number: String,
    pub(super) unit: String,
    pub(super) kind: Kind,
}

impl QuantityText {
    /// Splits `text` into a number and a unit.
    pub(super) fn new(text: &str, kind: Kind) -> Result<Self, QuantityError> {
        let trimmed = shown(text.trim());
        if trimmed.is_empty() {
            return Err(QuantityError::Empty { kind });
        }
        let bare = trimmed.trim_start_matches(['+', '-']).to_ascii_lowercase();
        if bare.starts_with("nan") || bare.starts_with("inf") {
            return Err(QuantityError::NotFinite { text: trimmed, kind });
        }
        let length = number_length(&trimmed);
        if length == 0 {
            return Err(QuantityError::NotANumber { text: trimmed, kind });
        }
        let (number, unit) = trimmed.split_at(length);
        if unit.starts_with(',') {
            return Err(QuantityError::Comma { text: trimmed });
        }
        let unit = unit.trim().replace('\u{3bc}', "\u{b5}"); // Greek mu to micro sign
        if unit.is_empty() {
            return Err(QuantityError::NoUnit { text: trimmed, kind });
        }
        Ok(Self { number: number.to_owned(), unit, text: trimmed, kind })
    }

    /// Returns the number in the unit of its kind.
    pub(super) fn value(self) -> Result<f64, QuantityError> {
        let Some(factor) = self.kind.factor(&self.unit) else {
            return Err(self.unknown_unit());
        };
        match self.number.parse::<f64>().map(|number| number * factor) {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(QuantityError::NotFinite { text: self.text, kind: self.kind }),
        }
    }

    /// Returns the error for a unit that this kind does not accept.
    pub(super) fn unknown_unit(self) -> QuantityError {
        let hint = self.kind.hint(&self.unit);
        QuantityError::UnknownUnit { text: self.text, unit: self.unit, kind: self.kind, hint }
    }
}

/// Returns the length of the number at the start of `text`: sign, digits, point, digits, exponent. Returns
/// zero if there is no number.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes.iter().skip(from).take_while(|byte| byte.is_ascii_digit()).count();
    let mut at = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let whole = digits(at);
    at += whole;
    let mut fraction = 0;
    if bytes.get(at) == Some(&b'.') {
        fraction = digits(at + 1);
        at += 1 + fraction;
    }
    if whole + fraction == 0 {
        return 0;
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
        let exponent = digits(at + 1 + sign);
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    at
}

/// Returns the text with ASCII minus signs, as the user typed them. A leading minus may arrive as U+2212, by
/// which the command line tells a negative amount from an option.
pub(super) fn shown(text: &str) -> String {
    text.replace('\u{2212}', "-")
}
