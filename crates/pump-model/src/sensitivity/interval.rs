//! A step of fixed length inside a stretch at constant speed.

use crate::line::oscillator::Oscillator;

use super::augmented::{Flows, LINE, STATES};
use super::propagator::{InputWeights, SensitivePropagator};

/// Numbers of all states side by side, so that a processor takes several at once.
type Numbers = [f64; STATES];

/// Input to x and y of all states as polynomials in the time since the stretch's start, lowest order first.
pub(super) type Inputs = [[Numbers; 5]; 2];

/// Effect of a step of fixed length on the states (x, y) inside the stretch under way.
#[derive(Debug, Clone)]
pub(super) struct Interval {
    weights: InputWeights,
    /// The matrix e^(A h) by rows.
    decay: [[f64; 2]; 2],
    /// Derivatives by rows; 0 but for those by R, C and L.
    decay_by: [[Numbers; 2]; 2],
    inputs: Inputs,
    /// True if the inputs do not change with time.
    is_even: bool,
}

impl Interval {
    pub(super) fn new(oscillator: &Oscillator, step_s: f64) -> Self {
        let propagator = SensitivePropagator::new(oscillator, step_s, 4);
        let [[a, b], [c, d]] = propagator.decay();
        let mut decay_by = [[[0.0; STATES]; 2]; 2];
        for (n, columns) in propagator.decay_by_line().iter().enumerate().take(LINE) {
            for (k, column) in columns.iter().enumerate() {
                for (row, element) in decay_by.iter_mut().zip(column) {
                    row[k][1 + n] = *element;
                }
            }
        }
        Self {
            weights: propagator.input_weights(),
            decay: [[a, c], [b, d]],
            decay_by,
            inputs: Inputs::default(),
            is_even: true,
        }
    }

    /// Takes the flows of another stretch. Returns false if they are of a degree that needs other steps.
    pub(super) fn take(&mut self, flows: &Flows) -> bool {
        if flows.line.degree > 4 {
            return false;
        }
        self.inputs = self.weights.inputs(flows);
        self.is_even = flows.are_even();
        true
    }

    /// True if the inputs do not change with time.
    pub(super) fn is_even(&self) -> bool {
        self.is_even
    }

    /// Returns the states (x, y) a step after that at time `t`. The inputs must not change with time if they are
    /// `EVEN`.
    #[inline(always)]
    pub(super) fn after<const EVEN: bool>(&self, x: &Numbers, y: &Numbers, t: f64) -> (Numbers, Numbers) {
        let row = |row: usize| {
            let [even, first, second, third, last] = &self.inputs[row];
            let ([by_x, by_y], [slopes_x, slopes_y]) = (self.decay[row], &self.decay_by[row]);
            let mut after = [0.0; STATES];
            for n in 0..STATES {
                let forced = if EVEN {
                    even[n]
                } else {
                    (((last[n] * t + third[n]) * t + second[n]) * t + first[n]) * t + even[n]
                };
                after[n] = forced + ((by_x * x[n] + by_y * y[n]) + (slopes_x[n] * x[0] + slopes_y[n] * y[0]));
            }
            after
        };
        (row(0), row(1))
    }
}
