//! Harmonics of a flow: the sines into which its pulsation divides.

use libm::{ceil, cos, sin};

use crate::head::flow_curve::{FlowCurve, FlowPiece};
use crate::units::TURN_RAD;

use super::ripple::NODES;

/// Largest phase of a part over which the rule integrates, rad. The rule is exact to degree 9, and what is left of a
/// quartic times a sine is below rounding.
const PART_RAD: f64 = 0.5;

/// Least phase of a piece whose integral is taken in closed form, rad. Below it the terms of that form cancel.
const CLOSED_RAD: f64 = 4.0;

impl FlowCurve {
    /// Returns the `number`th harmonic of the flow per radian, mL/rad: the amplitudes of its cosine and of its sine.
    ///
    /// The flow per radian at an angle is `pitch_ml / pitch_rad` plus the sum of `cosine` cos(n w angle) + `sine`
    /// sin(n w angle) over n = 1, 2, ..., with w = 2 pi / `pitch_rad`.
    ///
    /// ```
    /// let pump = pump_model::Pump::three_roller();
    /// let curve = pump.outlet_curve();
    /// // Parseval: the squares of all harmonics add up to twice the square of the ripple.
    /// let squares = (1..=200).map(|n| curve.harmonic_ml_rad(n)).map(|(c, s)| c * c + s * s).sum::<f64>();
    /// let mean = curve.pitch_ml() / curve.pitch_rad();
    /// assert!((f64::sqrt(0.5 * squares) / mean / curve.ripple().rms - 1.0).abs() < 1e-6);
    /// ```
    pub fn harmonic_ml_rad(&self, number: u32) -> (f64, f64) {
        let frequency = f64::from(number) * TURN_RAD / self.pitch_rad();
        let (mut cosine, mut sine) = (0.0, 0.0);
        for piece in self.pieces() {
            let (with_cosine, with_sine) = match frequency * piece.length_rad < CLOSED_RAD {
                true => by_parts(piece, frequency),
                false => in_closed_form(piece, frequency),
            };
            cosine += with_cosine;
            sine += with_sine;
        }
        let scale = 2.0 / self.pitch_rad();
        (scale * cosine, scale * sine)
    }
}

/// Returns the integrals of a piece's flow times the cosine and the sine of its phase, mL, by a rule over parts of the
/// piece.
fn by_parts(piece: &FlowPiece, frequency: f64) -> (f64, f64) {
    let (mut cosine, mut sine) = (0.0, 0.0);
    let parts = ceil(frequency * piece.length_rad / PART_RAD).max(1.0);
    let half = 0.5 * piece.length_rad / parts;
    for part in 0..parts as u32 {
        let middle = (2.0 * f64::from(part) + 1.0) * half;
        for (node, weight) in NODES {
            let place = middle + half * node;
            let flow = half * weight * piece.flow.at(place);
            let phase = frequency * (piece.start_rad + place);
            cosine += flow * cos(phase);
            sine += flow * sin(phase);
        }
    }
    (cosine, sine)
}

/// Returns what [`by_parts`] does, by the antiderivative: that of p exp(iwx) is exp(iwx) times the sum of
/// (-1)^k p^(k) / (iw)^(k + 1).
fn in_closed_form(piece: &FlowPiece, frequency: f64) -> (f64, f64) {
    let mut derivative = piece.flow;
    // Sums at the start and at the end of the piece, each with its real and its imaginary part.
    let mut sums = [[0.0; 2]; 2];
    let mut factor = 1.0 / frequency;
    for order in 0..derivative.c.len() {
        // The factors (-1)^k / i^(k + 1) are -i, 1, i, -1, and so on.
        let (part, sign) = [(1, -1.0), (0, 1.0), (1, 1.0), (0, -1.0)][order % 4];
        for (sum, place) in sums.iter_mut().zip([0.0, piece.length_rad]) {
            sum[part] += sign * factor * derivative.at(place);
        }
        derivative = derivative.derivative();
        factor /= frequency;
    }
    let at = |[real, imaginary]: [f64; 2], place: f64| {
        let phase = frequency * (piece.start_rad + place);
        let (cosine, sine) = (cos(phase), sin(phase));
        (cosine * real - sine * imaginary, cosine * imaginary + sine * real)
    };
    let (start, end) = (at(sums[0], 0.0), at(sums[1], piece.length_rad));
    (end.0 - start.0, end.1 - start.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pump;

    #[test]
    fn the_closed_form_is_the_rule_over_parts() {
        for pump in [Pump::three_roller(), Pump::two_roller()] {
            for piece in [pump.inlet_curve(), pump.outlet_curve()].iter().flat_map(|curve| curve.pieces()) {
                for phase in [CLOSED_RAD, 5.0, 7.3, 40.0, 1000.0] {
                    let frequency = phase / piece.length_rad;
                    let (rule, closed) = (by_parts(piece, frequency), in_closed_form(piece, frequency));
                    let most = 1e-13 * piece.length_rad.max(1.0);
                    assert!((rule.0 - closed.0).abs() < most, "{phase}: {rule:?} {closed:?}");
                    assert!((rule.1 - closed.1).abs() < most, "{phase}: {rule:?} {closed:?}");
                }
            }
        }
    }
}
