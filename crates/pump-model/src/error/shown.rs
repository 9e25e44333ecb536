//! Numbers in messages.

use core::fmt;

use libm::{fabs, floor, log10, pow, round};

/// A number as a message shows it: with six significant digits, or with an exponent where it would have dozens of
/// digits. Whole numbers keep all of theirs.
///
/// ```
/// use pump_model::Shown;
/// assert_eq!(Shown(1e9).to_string(), "1000000000");
/// assert_eq!(Shown(1e300).to_string(), "1e300");
/// assert_eq!(Shown(4.015_362_662_688_751_5).to_string(), "4.01536");
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
            None => write!(f, "{}", six_digits(value)),
        }
    }
}

/// Rounds a number to six significant digits, and no whole number.
fn six_digits(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let scale = pow(10.0, (5.0 - floor(log10(fabs(value)))).max(0.0));
    round(value * scale) / scale
}
