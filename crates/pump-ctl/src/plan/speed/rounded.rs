//! Numbers rounded for messages, to the side on which they can be had.

use pump_model::math::{ceil, floor, log10, pow};

/// Digits of a rounded number.
const DIGITS: f64 = 5.0;

/// The power of ten that makes [`DIGITS`] digits of a positive number whole.
pub(super) fn scale(x: f64) -> f64 {
    pow(10.0, DIGITS - 1.0 - floor(log10(x)))
}

/// Rounds `x` up, so that a number which a message says is needed is enough.
pub(super) fn up(x: f64) -> f64 {
    ceil(x * scale(x)) / scale(x)
}

/// Rounds `x` down, so that a number which a message says can be had can be had.
pub(super) fn down(x: f64) -> f64 {
    floor(x * scale(x)) / scale(x)
}
