//! Ripple: the departure of a flow from its mean.

use libm::sqrt;

use crate::head::flow_curve::FlowCurve;

use super::leg::Leg;
use super::stretches::Stretches;

/// Departure of a flow from its mean over time, as fractions of the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ripple {
    /// Largest less smallest flow, over the mean.
    pub peak_to_peak: f64,
    /// Root of the mean square deviation, over the mean.
    pub rms: f64,
}

impl Ripple {
    /// Returns the ripple over time of the flow that a motion makes at the rollers of a curve, whatever the
    /// direction: in reverse the flow counts mirrored. Every leg must end. Returns none if there is no flow.
    ///
    /// In a stretch between edges and corners the flow is a polynomial of time, of degree 9 at most. Its
    /// square is integrated with an error far below rounding where a stretch is a part of a pulse. The
    /// extremes are those of equally spaced looks, [`Self::LOOKS`] intervals a stretch, ends included.
    pub fn of_motion<M: Iterator<Item = Leg>>(
        curve: &FlowCurve,
        legs: impl IntoIterator<IntoIter = M>,
    ) -> Option<Self> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut time_s, mut volume_ml, mut square) = (0.0, 0.0, 0.0);
        for stretch in Stretches::new(curve, legs).take_while(|stretch| stretch.end_s.is_finite()) {
            let length_s = stretch.end_s - stretch.start_s;
            let middle_s = stretch.start_s + 0.5 * length_s;
            let direction = if stretch.leg.speed_at(middle_s) < 0.0 { -1.0 } else { 1.0 };
            let flow_ml_s = |elapsed_s: f64| direction * stretch.flow_ml_s(stretch.start_s + elapsed_s);
            time_s += length_s;
            volume_ml += integral(flow_ml_s, length_s);
            square += square_integral(flow_ml_s, length_s);
            for look in 0..=Self::LOOKS {
                let there_ml_s = flow_ml_s(length_s * f64::from(look) / f64::from(Self::LOOKS));
                low = low.min(there_ml_s);
                high = high.max(there_ml_s);
            }
        }
        let mean = volume_ml / time_s;
        (mean > 0.0).then(|| Self {
            peak_to_peak: (high - low) / mean,
            rms: sqrt((square / time_s - mean * mean).max(0.0)) / mean,
        })
    }

    /// Number of intervals of a stretch between the places at which the flow is looked at for its extremes.
    pub const LOOKS: u32 = 8;
}

impl FlowCurve {
    /// Returns the peak-to-peak and root-mean-square deviation of the flow at constant speed, both divided by
    /// its mean.
    pub fn ripple(&self) -> Ripple {
        let mean = self.pitch_ml() / self.pitch_rad();
        let (low, high) = self.flow_range_ml_rad();
        let square =
            self.pieces().iter().map(|piece| square_integral(|x| piece.flow.at(x), piece.length_rad));
        let mean_square = square.sum::<f64>() / self.pitch_rad();
        Ripple { peak_to_peak: (high - low) / mean, rms: sqrt((mean_square - mean * mean).max(0.0)) / mean }
    }
}

/// Nodes and weights of Gauss-Legendre quadrature with five nodes (Abramowitz and Stegun, table 25.4). The
/// rule is exact to degree 9.
pub(super) const NODES: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// Returns the integral over [0, length], exact for polynomials to degree 9.
fn integral(value: impl Fn(f64) -> f64, length: f64) -> f64 {
    let half = 0.5 * length;
    NODES.iter().map(|(x, weight)| half * weight * value(half * (1.0 + x))).sum()
}

/// Returns the integral of the square over [0, length], exact for polynomials to degree 4.
pub(crate) fn square_integral(value: impl Fn(f64) -> f64, length: f64) -> f64 {
    let half = 0.5 * length;
    NODES
        .iter()
        .map(|(x, weight)| {
            let value = value(half * (1.0 + x));
            half * weight * value * value
        })
        .sum()
}
