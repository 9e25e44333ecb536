//! The exact solution of a line and of its derivatives over a step of fixed length.
//!
//! The derivative of e^(A h) by a parameter is the upper right block of the exponential of [[A, E], [0, A]] with
//! E = dA/dp (Mathias, "A chain rule for matrix functions", SIAM J. Matrix Anal. 17, 1996). Scaling and squaring
//! of that block matrix is the product rule in each doubling.

use crate::line::oscillator::{Balanced, Oscillator};
use crate::line::propagator::{Propagator, RECIPROCALS, TERMS, product};
use crate::motion::flow::DEGREE;

use super::augmented::{ANGLE, Augmented, ByLine, Flows, LINE, ROLLER, STATES};
use super::short_steps::by_input;

/// Derivatives of a [`Propagator`] by one of the line's parameters.
#[derive(Debug, Clone, Copy)]
struct Slope {
    /// Derivative of e^(A h) by columns.
    change: [Balanced; 2],
    /// Derivatives of the responses.
    response: [Balanced; DEGREE + 1],
}

/// Effect of a step of fixed length on an augmented state.
#[derive(Debug, Clone, Copy)]
pub(super) struct SensitivePropagator {
    propagator: Propagator,
    slopes: ByLine<Slope>,
    degree: usize,
}

impl SensitivePropagator {
    /// Builds the propagator for steps of `h` and flows of `degree` at most.
    pub(super) fn new(oscillator: &Oscillator, h: f64, degree: usize) -> Self {
        let (short, doublings) = oscillator.halved(h);
        let mut whole = Self::short(oscillator, short, degree);
        for _ in 0..doublings {
            for slope in &mut whole.slopes {
                *slope = slope.doubled(&whole.propagator, degree);
            }
            whole.propagator.double();
        }
        // Halving and doubling are exact, so the length is h again.
        whole.propagator.step_s = h;
        whole
    }

    /// Builds the propagator of a short step by Taylor series, term by term beside those of [`Propagator`].
    fn short(oscillator: &Oscillator, h: f64, degree: usize) -> Self {
        const NONE: Slope = Slope { change: [[0.0; 2]; 2], response: [[0.0; 2]; DEGREE + 1] };
        let mut slopes = [NONE; LINE];
        let mut columns = [[1.0, 0.0], [0.0, 1.0]];
        let mut by_columns = [[[0.0; 2]; LINE]; 2];
        let mut term = [h * oscillator.rate * oscillator.impedance, 0.0];
        let mut by_term = by_input(term);
        // The weights k!/(n+k)!, starting at n = 1.
        let mut weights = [0.0; DEGREE + 1];
        weights.copy_from_slice(&RECIPROCALS[1..DEGREE + 2]);
        for (n, reciprocal) in RECIPROCALS.iter().enumerate().skip(1).take(TERMS) {
            let factor = h * reciprocal;
            for (k, (column, by_column)) in columns.iter_mut().zip(&mut by_columns).enumerate() {
                (*column, *by_column) = oscillator.next_term(factor, *column, by_column);
                for (slope, by) in slopes.iter_mut().zip(by_column) {
                    slope.change[k] = [slope.change[k][0] + by[0], slope.change[k][1] + by[1]];
                }
            }
            let next = RECIPROCALS.iter().skip(n + 1);
            for (k, (weight, reciprocal)) in weights.iter_mut().zip(next).take(degree + 1).enumerate() {
                for (slope, by) in slopes.iter_mut().zip(&by_term) {
                    let sum = &mut slope.response[k];
                    *sum = [sum[0] + *weight * by[0], sum[1] + *weight * by[1]];
                }
                *weight *= reciprocal;
            }
            (term, by_term) = oscillator.next_term(h, term, &by_term);
        }
        Self { propagator: Propagator::short(oscillator, h, degree), slopes, degree }
    }

    /// Returns the augmented state a step after `state`. The flows count time from there.
    pub(super) fn apply(&self, state: &Augmented, flows: &Flows) -> Augmented {
        let mut after = [[0.0; 2]; STATES];
        after[0] = self.propagator.apply(state[0], &flows.line);
        after[ANGLE] = self.propagator.apply(state[ANGLE], &flows.by_angle);
        after[ROLLER] = self.propagator.apply(state[ROLLER], &flows.by_roller);
        for ((after, before), slope) in after.iter_mut().skip(1).zip(state.iter().skip(1)).zip(&self.slopes) {
            let (moved, by) = (self.propagator.moved(*before), product(&slope.change, state[0]));
            let mut sum = [moved[0] + by[0], moved[1] + by[1]];
            let mut power = 1.0;
            for (c, response) in flows.line.terms().zip(&slope.response).take(self.degree + 1) {
                sum = [sum[0] + power * c * response[0], sum[1] + power * c * response[1]];
                power *= self.propagator.step_s;
            }
            *after = sum;
        }
        after
    }

    /// Returns e^(A h) z.
    pub(super) fn moved(&self, state: Balanced) -> Balanced {
        self.propagator.moved(state)
    }

    /// Returns the derivatives of e^(A h) by R, C and L, by columns.
    pub(super) fn decay_by_line(&self) -> ByLine<[Balanced; 2]> {
        self.slopes.map(|slope| slope.change)
    }

    /// Returns the derivatives by R, C and L of the responses to flows of (t/h)^k.
    pub(super) fn responses_by_line(&self) -> ByLine<[Balanced; DEGREE + 1]> {
        self.slopes.map(|slope| slope.response)
    }
}

impl Slope {
    /// Returns the derivatives for a step twice as long as that of `single`: those of `Propagator::double`.
    fn doubled(&self, single: &Propagator, degree: usize) -> Self {
        let mut doubled = *self;
        let mut scale = 1.0;
        for (k, doubled) in doubled.response.iter_mut().enumerate().take(degree + 1) {
            let by = product(&self.change, single.response[k]);
            let moved = single.moved(*doubled);
            let mut sum = [moved[0] + by[0], moved[1] + by[1]];
            let mut binomial = 1.0;
            let next = RECIPROCALS.iter().skip(1);
            for ((j, response), reciprocal) in self.response.iter().enumerate().zip(next).take(k + 1) {
                sum = [sum[0] + binomial * response[0], sum[1] + binomial * response[1]];
                binomial *= (k - j) as f64 * reciprocal;
            }
            *doubled = sum.map(|x| scale * x);
            scale *= 0.5;
        }
        for ((doubled, by), column) in doubled.change.iter_mut().zip(self.change).zip(single.change) {
            let (one, other) = (product(&self.change, column), single.changed(by));
            *doubled = [2.0 * by[0] + one[0] + other[0], 2.0 * by[1] + one[1] + other[1]];
        }
        doubled
    }
}
