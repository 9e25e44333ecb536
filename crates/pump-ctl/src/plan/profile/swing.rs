//! The swing of the line under a flow that repeats itself, in single precision.
//!
//! The swing serves to compare envelopes. Its numbers enter no report, so seven digits suffice. Single
//! precision is in a microcontroller's hardware, and IEEE 754 makes the same bits everywhere.

use libm::{ceilf, sqrt};
use pump_model::Line;

/// Largest length of a step in units of the fastest rate of change.
const SHORT: f32 = 0.5;

/// Largest number of steps in a period. A line that needs more swings so fast that it follows the flow.
const MOST_STEPS: f64 = 4096.0;

/// Number of terms of the series over a step: 0.5^7/7! is 2e-6.
const TERMS: usize = 7;

/// Table of 1/n.
const RECIPROCALS: [f32; TERMS + 1] = [0.0, 1.0, 0.5, 1.0 / 3.0, 0.25, 0.2, 1.0 / 6.0, 1.0 / 7.0];

/// The flow at the line's end and its slope over w, both mL/s. With time in units of 1/w they obey y' = v,
/// v' = f - y - 2 z v under the flow f at the rollers.
type State = [f32; 2];

/// A line that swings under a flow of a certain period.
#[derive(Debug, Clone, Copy)]
pub(super) struct Swing {
    /// Natural frequency w, rad/s.
    natural_rad_s: f32,
    /// Twice the damping ratio, 2 z.
    damping: f32,
    /// Matrix that takes the flow's share of the state after a period from rest to the state that repeats
    /// itself, (I - e^(A T))^-1, by rows.
    repeating: [State; 2],
}

/// Smallest and largest flow at the line's end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outflow {
    low: f32,
    high: f32,
}

impl Outflow {
    /// Returns the largest less the smallest flow, mL/s.
    pub(super) fn peak_to_peak(&self) -> f32 {
        self.high - self.low
    }

    fn cover(&mut self, flow: f32) {
        self.low = self.low.min(flow);
        self.high = self.high.max(flow);
    }
}

impl Swing {
    /// Makes the swing of a line under flows that repeat themselves every `period_s`. It is none for a line
    /// that nothing damps at a resonance, and for one that is so fast that it follows the flow.
    pub(super) fn new(line: &Line, period_s: f64) -> Option<Self> {
        let natural_rad_s = 1.0 / sqrt(line.inertance_kpa_s2_ml * line.compliance_ml_kpa);
        let damping = 2.0 * line.damping_ratio();
        let steps = natural_rad_s * period_s * (1.0 + damping) / f64::from(SHORT);
        if !(steps > 0.0 && steps <= MOST_STEPS) {
            return None;
        }
        // e^(A T) is e^(A h) of a short h, by its series, squared up to T. There are 12 squarings at most.
        let mut parts = 1.0;
        while parts < steps {
            parts *= 2.0;
        }
        let mut change = short_change(natural_rad_s * period_s / parts, damping);
        while parts > 1.0 {
            change = doubled(change);
            parts *= 0.5;
        }
        // I - e^(A T) is the change with the opposite sign.
        let [[a, b], [c, d]] = change;
        let determinant = a * d - b * c;
        /// Smallest determinant that single precision tells from the zero of a resonance.
        const RESONANT: f64 = 1e-4;
        (determinant > RESONANT).then(|| Self {
            natural_rad_s: natural_rad_s as f32,
            damping: damping as f32,
            repeating: [
                [(-d / determinant) as f32, (b / determinant) as f32],
                [(c / determinant) as f32, (-a / determinant) as f32],
            ],
        })
    }

    /// Returns the range of the flow at the line's end, or none if it exceeds `most`, mL/s. `parts` are the parts of a
    /// period, each with its duration, s, and the flows at the rollers at its ends, mL/s, between which the flow is
    /// taken as linear.
    pub(super) fn outflow(
        &self,
        parts: impl Iterator<Item = (f32, f32, f32)> + Clone,
        most: f32,
    ) -> Option<Outflow> {
        let after = parts.clone().fold([0.0; 2], |state, part| self.along(state, part, |_| {}));
        let [one, two] = self.repeating.map(|[y, v]| y * after[0] + v * after[1]);
        let mut outflow = Outflow { low: one, high: one };
        let mut state = [one, two];
        for part in parts {
            state = self.along(state, part, |flow| outflow.cover(flow));
            if outflow.peak_to_peak() > most {
                return None;
            }
        }
        Some(outflow)
    }

    /// Returns the state at the end of a part, and reports the flows at the line's end on the way.
    fn along(
        &self,
        mut state: State,
        (duration_s, from, to): (f32, f32, f32),
        mut see: impl FnMut(f32),
    ) -> State {
        let length = self.natural_rad_s * duration_s;
        let steps = ceilf(length * (1.0 + self.damping) / SHORT).max(1.0).min(MOST_STEPS as f32);
        let (short, rise) = (length / steps, (to - from) / steps);
        let mut flow = from;
        for _ in 0..steps as u32 {
            state = self.after(short, state, flow, rise);
            flow += rise;
            see(state[0]);
        }
        state
    }

    /// Returns the state a step of length `h` after `state`, by its series. The flow rises by `rise`.
    fn after(&self, h: f32, state: State, flow: f32, rise: f32) -> State {
        let [mut y, mut v] = state;
        let [mut sum_y, mut sum_v] = state;
        let mut forcing = [flow, rise].into_iter();
        for reciprocal in RECIPROCALS.iter().skip(1) {
            let factor = h * reciprocal;
            let forced = forcing.next().unwrap_or(0.0);
            (y, v) = (factor * v, factor * (forced - y - self.damping * v));
            sum_y += y;
            sum_v += v;
        }
        [sum_y, sum_v]
    }
}

/// A matrix of two rows.
type Matrix = [[f64; 2]; 2];

/// Returns e^(A h) - I for a short h, by rows: the sum of (A h)^n/n! from n = 1 on.
fn short_change(h: f64, damping: f64) -> Matrix {
    let mut term: Matrix = [[1.0, 0.0], [0.0, 1.0]];
    let mut sum: Matrix = [[0.0; 2]; 2];
    for n in 1..=16 {
        let factor = h / f64::from(n);
        let [y, v] = term;
        let row = |of: fn(f64, f64, f64) -> f64| [of(y[0], v[0], damping), of(y[1], v[1], damping)];
        term = [row(|_, v, _| v), row(|y, v, damping| -y - damping * v)].map(|row| row.map(|x| factor * x));
        for (sum, term) in sum.as_flattened_mut().iter_mut().zip(term.as_flattened()) {
            *sum += term;
        }
    }
    sum
}

/// Returns F' = 2 F + F² for F = e^(A h) - I, the change over twice the time.
fn doubled(change: Matrix) -> Matrix {
    let [[a, b], [c, d]] = change;
    [[2.0 * a + a * a + b * c, 2.0 * b + b * (a + d)], [2.0 * c + c * (a + d), 2.0 * d + d * d + b * c]]
}
