//! Numbers rounded for messages, to the side on which a request is accepted.

use libm::{ceil, floor, log10, pow};

/// Number of digits of a rounded number.
const DIGITS: f64 = 5.0;

/// Returns the power of ten that makes [`DIGITS`] digits of a positive number whole.
///
/// It is cold: refusals alone round, and its powers inlined wherever they do would take 4 kB of flash.
#[cold]
pub(super) fn scale(x: f64) -> f64 {
    pow(10.0, DIGITS - 1.0 - floor(log10(x)))
}

/// Rounds `x` up. A message that names the result as needed then names enough.
pub(in crate::plan) fn up(x: f64) -> f64 {
    ceil(x * scale(x)) / scale(x)
}

/// Rounds `x` down. A message that names the result as possible then names a possible value.
pub(super) fn down(x: f64) -> f64 {
    floor(x * scale(x)) / scale(x)
}
