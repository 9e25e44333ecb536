//! Harmonics of a flow: the sines into which its pulsation divides.

use libm::{ceil, cos, sin};

use crate::head::flow_curve::FlowCurve;
use crate::units::TURN_RAD;

use super::ripple::NODES;

/// Largest phase of a part over which the rule integrates, rad. The rule is exact to degree 9, and what is left of a
/// quartic times a sine is below rounding.
const PART_RAD: f64 = 0.5;

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
        }
        let scale = 2.0 / self.pitch_rad();
        (scale * cosine, scale * sine)
    }
}
