//! Quintic Hermite interpolation between two ends with known value, slope and curvature.

use core::ops::{Add, Mul, Sub};

/// Value, slope and curvature at one end of an interval, for a number or for a vector.
pub(crate) struct End<T> {
    pub(crate) value: T,
    pub(crate) slope: T,
    pub(crate) curvature: T,
}

/// Returns the polynomial through both ends of an interval of this length. The coefficients, lowest order
/// first, are over x = (t - start) / length.
#[inline]
pub(crate) fn quintic<T>(length: f64, from: &End<T>, to: &End<T>) -> [T; 6]
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    let h = length;
    let rise = to.value - from.value;
    let (d0, d1) = (from.slope * h, to.slope * h);
    let (e0, e1) = (from.curvature * (h * h), to.curvature * (h * h));
    [
        from.value,
        d0,
        e0 * 0.5,
        rise * 10.0 - d0 * 6.0 - d1 * 4.0 - e0 * 1.5 + e1 * 0.5,
        rise * -15.0 + d0 * 8.0 + d1 * 7.0 + e0 * 1.5 - e1,
        rise * 6.0 - (d0 + d1) * 3.0 + (e1 - e0) * 0.5,
    ]
}
