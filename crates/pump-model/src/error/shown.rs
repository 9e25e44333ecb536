//! Numbers in messages.

use core::fmt;

/// A number as a message shows it: in full, or with an exponent where it would have dozens of digits.
///
/// ```
/// use pump_model::Shown;
/// assert_eq!(Shown(1e9).to_string(), "1000000000");
/// assert_eq!(Shown(1e300).to_string(), "1e300");
/// assert_eq!(format!("{:.2}", Shown(2.0 / 3.0)), "0.67");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown(pub f64);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        if value != 0.0 && !(1e-6..1e15).contains(&value.abs()) {
            return write!(f, "{value:e}");
        }
        match f.precision() {
            Some(decimals) => write!(f, "{value:.decimals$}"),
            None => write!(f, "{value}"),
        }
    }
}
