//! Errors of what a smooth flow relies on, at equal probability: roller volume, engagement angle, start angle. The demo
//! in the browser compiles this file too, so it needs neither std nor this crate.

use core::f64::consts::TAU;

use libm::{ceil, cos, log, sqrt};

/// Number of errors that are drawn.
pub(super) const DRAWS: u32 = 64;

/// Part of the draws whose ripple is at most the one that is reported.
pub(super) const COVERED: f64 = 0.95;

/// Standard errors of a pump, each 1 for a draw of normal numbers, and a uniform number from -1 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draw {
    /// Error of the roller volume, in standard uncertainties.
    pub(super) roller_volume: f64,
    /// Error of the engagement angle, in standard uncertainties.
    pub(super) engagement: f64,
    /// Error of the zero of the angle, in standard uncertainties.
    pub(super) zero: f64,
    /// Error of the start angle, in half widths.
    pub(super) start: f64,
}

/// Returns the draws, the same at every call.
///
/// They are Halton's points in bases 2, 3, 5, 7 and 11 (Numerische Mathematik 2:84, 1960), which fill the space
/// of the errors evenly. Two uniform numbers make a normal one after Box and Muller (Ann. Math. Stat. 29:610,
/// 1958).
pub(super) fn draws() -> impl Iterator<Item = Draw> {
    (1..=DRAWS).map(|number| {
        let [a, b, c, d, e] = [2, 3, 5, 7, 11].map(|base| radical_inverse(number, base));
        let normal = |length: f64, turn: f64| sqrt(-2.0 * log(length)) * cos(TAU * turn);
        let sine = normal(a, b + 0.25);
        Draw { roller_volume: normal(a, b), engagement: sine, zero: normal(c, d), start: 2.0 * e - 1.0 }
    })
}

/// Returns the value that a part of the `sorted` ones does not exceed, or `None` if there are none.
pub(super) fn covering(sorted: &[f64], part: f64) -> Option<f64> {
    let rank = ceil(part * sorted.len() as f64) as usize;
    sorted.get(rank.saturating_sub(1)).copied()
}

/// Returns the digits of `number` in a base, mirrored at the point: between 0 and 1.
fn radical_inverse(number: u32, base: u32) -> f64 {
    let (mut left, mut place, mut sum) = (number, 1.0, 0.0);
    while left > 0 {
        place /= f64::from(base);
        sum += place * f64::from(left % base);
        left /= base;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_draws_have_the_moments_of_their_distributions() {
        let mean = |of: &dyn Fn(&Draw) -> f64| draws().map(|draw| of(&draw)).sum::<f64>() / f64::from(DRAWS);
        for of in [|draw: &Draw| draw.roller_volume, |draw: &Draw| draw.engagement, |draw: &Draw| draw.zero] {
            assert!(mean(&of).abs() < 0.1, "{}", mean(&of));
            let square = mean(&|draw| of(draw) * of(draw));
            assert!((square - 1.0).abs() < 0.15, "{square}");
        }
        // A uniform number from -1 to 1 has a variance of 1/3.
        assert!(mean(&|draw| draw.start).abs() < 0.05);
        assert!((mean(&|draw| draw.start * draw.start) - 1.0 / 3.0).abs() < 0.03);
        assert!(mean(&|draw| draw.roller_volume * draw.engagement).abs() < 0.1);
    }
}
