//! The exact solution of a line over a time in which the flow at the rollers is a polynomial.
//!
//! Between two edges the model is linear with polynomial forcing, z' = A z + b f(t), so that z(h) = e^(A h)
//! z(0) + integral of e^(A (h - t)) b f(t) dt. There are two ways to sum it, both exact to rounding. A short
//! step takes the Taylor series of z. A long step takes matrices for a short step, doubled until it is long
//! enough (scaling and squaring, after Higham, "Functions of Matrices", chapter 10). Neither divides by A, so
//! slow, stiff, critically damped and undamped lines are one case.

use crate::motion::flow::{DEGREE, Flow};
use crate::port::Port;

use super::line::Line;
use super::line_state::LineState;
use super::oscillator::{Balanced, Oscillator, SHORT};

/// Number of terms of the series: 0.5^17/17! is below rounding.
pub(crate) const TERMS: usize = 17;

impl Oscillator {
    /// Returns the state `h` after `state`. `flow` counts time from there.
    pub(crate) fn after(&self, h: f64, state: Balanced, flow: &Flow) -> Balanced {
        if self.norm() * h <= SHORT {
            self.series(h, state, flow)
        } else {
            Propagator::new(self, h, flow.degree).apply(state, flow)
        }
    }

    /// Returns `h` halved until it is short, and how often it was halved. A step 2^1100 times shorter than any
    /// finite step is short.
    pub(crate) fn halved(&self, h: f64) -> (f64, u32) {
        let (mut short, mut halvings) = (h, 0);
        while self.norm() * short > SHORT && halvings < 1100 {
            short *= 0.5;
            halvings += 1;
        }
        (short, halvings)
    }

    /// Returns the state by its series: z(h) = sum of Z_n with Z_(n+1) = h (A Z_n + b f_n h^n) / (n + 1).
    fn series(&self, h: f64, state: Balanced, flow: &Flow) -> Balanced {
        let mut term = state;
        let mut sum = state;
        let mut power = self.rate * self.impedance;
        let mut forcing = flow.terms();
        for reciprocal in RECIPROCALS.iter().skip(1).take(TERMS) {
            let mut next = self.times(term);
            let forced = forcing.next();
            if let Some(c) = forced {
                next[0] += power * c;
                power *= h;
            }
            let factor = h * reciprocal;
            term = [factor * next[0], factor * next[1]];
            sum = [sum[0] + term[0], sum[1] + term[1]];
            // Beyond the flow's own terms, the terms fall by |A| h / n each.
            if forced.is_none() && term[0].abs() + term[1].abs() <= 1e-18 * (sum[0].abs() + sum[1].abs()) {
                break;
            }
        }
        sum
    }
}

/// Table of 1/n.
pub(crate) const RECIPROCALS: [f64; TERMS + DEGREE + 2] = {
    let mut table = [0.0; TERMS + DEGREE + 2];
    let mut n = 1;
    while n < table.len() {
        table[n] = 1.0 / n as f64;
        n += 1;
    }
    table
};

/// Effect of a time step of fixed length on the state of an [`Oscillator`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Propagator {
    pub(crate) step_s: f64,
    /// The matrix e^(A h) - I by columns. The difference keeps slow modes exact beside fast ones.
    pub(crate) change: [Balanced; 2],
    /// Responses gamma_k to flows of (t/h)^k.
    pub(crate) response: [Balanced; DEGREE + 1],
    degree: usize,
}

impl Propagator {
    /// Builds the propagator for steps of `h` and flows of `degree` at most.
    pub(crate) fn new(oscillator: &Oscillator, h: f64, degree: usize) -> Self {
        let (short, doublings) = oscillator.halved(h);
        let mut propagator = Self::short(oscillator, short, degree);
        for _ in 0..doublings {
            propagator.double();
        }
        // Halving and doubling are exact, so the length is h again.
        propagator.step_s = h;
        propagator
    }

    /// Builds the propagator of a short step by Taylor series: e^(A h) - I = sum A^n h^n / n!, gamma_k = sum
    /// A^n b h^(n+1) k!/(n+k+1)!.
    pub(crate) fn short(oscillator: &Oscillator, h: f64, degree: usize) -> Self {
        let mut change = [[0.0; 2]; 2];
        let mut columns = [[1.0, 0.0], [0.0, 1.0]];
        let mut response = [[0.0; 2]; DEGREE + 1];
        let mut input = [h * oscillator.rate * oscillator.impedance, 0.0];
        // The weights k!/(n+k)!, starting at n = 1.
        let mut weights = [0.0; DEGREE + 1];
        weights.copy_from_slice(&RECIPROCALS[1..DEGREE + 2]);
        for (n, reciprocal) in RECIPROCALS.iter().enumerate().skip(1).take(TERMS) {
            for (sum, column) in change.iter_mut().zip(&mut columns) {
                let factor = h * reciprocal;
                *column = oscillator.times(*column).map(|x| factor * x);
                *sum = [sum[0] + column[0], sum[1] + column[1]];
            }
            let next = RECIPROCALS.iter().skip(n + 1);
            for ((sum, weight), reciprocal) in
                response.iter_mut().zip(&mut weights).zip(next).take(degree + 1)
            {
                *sum = [sum[0] + *weight * input[0], sum[1] + *weight * input[1]];
                *weight *= reciprocal;
            }
            input = oscillator.times(input).map(|x| h * x);
        }
        Self { step_s: h, change, response, degree }
    }

    /// Makes the step twice as long: F' = 2 F + F², gamma_k' = (e^(A h) gamma_k + sum_j C(k, j) gamma_j) /
    /// 2^k.
    pub(crate) fn double(&mut self) {
        let mut scale = 1.0;
        let mut doubled = self.response;
        for (k, doubled) in doubled.iter_mut().enumerate().take(self.degree + 1) {
            let mut sum = self.moved(*doubled);
            let mut binomial = 1.0;
            let next = RECIPROCALS.iter().skip(1);
            for ((j, response), reciprocal) in self.response.iter().enumerate().zip(next).take(k + 1) {
                sum = [sum[0] + binomial * response[0], sum[1] + binomial * response[1]];
                binomial *= (k - j) as f64 * reciprocal;
            }
            *doubled = sum.map(|x| scale * x);
            scale *= 0.5;
        }
        self.response = doubled;
        let twice = |column: Balanced| {
            let squared = self.changed(column);
            [2.0 * column[0] + squared[0], 2.0 * column[1] + squared[1]]
        };
        self.change = self.change.map(twice);
        self.step_s *= 2.0;
    }

    /// Returns (e^(A h) - I) z.
    pub(crate) fn changed(&self, state: Balanced) -> Balanced {
        product(&self.change, state)
    }

    /// Returns e^(A h) z.
    pub(crate) fn moved(&self, state: Balanced) -> Balanced {
        let change = self.changed(state);
        [state[0] + change[0], state[1] + change[1]]
    }

    /// Returns the state a step after `state`. `flow` counts time from there.
    pub(crate) fn apply(&self, state: Balanced, flow: &Flow) -> Balanced {
        let mut sum = self.moved(state);
        let mut power = 1.0;
        for (c, response) in flow.c.iter().zip(&self.response).take(flow.degree.min(self.degree) + 1) {
            sum = [sum[0] + power * c * response[0], sum[1] + power * c * response[1]];
            power *= self.step_s;
        }
        sum
    }

    /// Returns the state a step after `state`, with a constant flow of `flow_ml_s`.
    pub(crate) fn constant(&self, state: Balanced, flow_ml_s: f64) -> Balanced {
        let [[x, y], ..] = self.response;
        let [moved_x, moved_y] = self.moved(state);
        [moved_x + flow_ml_s * x, moved_y + flow_ml_s * y]
    }

    /// Returns the matrix e^(A h) - I by columns.
    pub(crate) fn change(&self) -> [Balanced; 2] {
        self.change
    }
}

/// Returns the product of a matrix, given by its columns, and a state.
pub(crate) fn product([first, second]: &[Balanced; 2], state: Balanced) -> Balanced {
    [first[0] * state[0] + second[0] * state[1], first[1] * state[0] + second[1] * state[1]]
}

/// The change of an outlet line's state over a time step with a constant flow at the rollers.
///
/// The change by the state is exact. A flow that is not constant counts by its mean over the step.
///
/// ```
/// use pump_model::{Line, LineState, LineStep};
///
/// let step = LineStep::new(&Line::PUBLISHED, 0.004);
/// let mut state = LineState::AT_REST;
/// for _ in 0..500 {
///     state = step.after(state, 5.0);
/// }
/// // After two seconds the line carries the flow, and R Q drives it.
/// assert!((state.flow_ml_s - 5.0).abs() < 1e-9);
/// assert!((state.above_reservoir_kpa - 5.0 * Line::PUBLISHED.resistance_kpa_s_ml).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineStep {
    oscillator: Oscillator,
    propagator: Propagator,
}

impl LineStep {
    /// Makes the step of an outlet `line` over `step_s`, s.
    pub fn new(line: &Line, step_s: f64) -> Self {
        let oscillator = Oscillator::new(line, Port::Outlet);
        Self { oscillator, propagator: Propagator::new(&oscillator, step_s, 0) }
    }

    /// Returns the state a step after `state`, with a flow of `flow_ml_s` at the rollers.
    pub fn after(&self, state: LineState, flow_ml_s: f64) -> LineState {
        let before = self.oscillator.balanced(state.numbers());
        LineState::of(self.oscillator.physical(self.propagator.constant(before, flow_ml_s)))
    }
}

impl Line {
    /// Returns the state of an outlet line `time_s`, s, after `state`, with a constant flow of `flow_ml_s`, mL/s, at
    /// the rollers.
    ///
    /// It is the exact solution, z(t) = e^(A t) z(0) + integral of e^(A (t - u)) b Q du (Higham, "Functions of
    /// Matrices", chapter 10). For many steps of one length [`LineStep`] is faster.
    ///
    /// ```
    /// use pump_model::{Line, LineState};
    ///
    /// // A volume that is pushed in at once swings out: p(t) = p(0) e^(-d t/2) (cos v t + d/(2 v) sin v t), d = R/L.
    /// let line = Line::PUBLISHED;
    /// let pushed = LineState { above_reservoir_kpa: 1.0, flow_ml_s: 0.0 };
    /// let d = line.resistance_kpa_s_ml / line.inertance_kpa_s2_ml;
    /// let v = (line.natural_rad_s().powi(2) - 0.25 * d * d).sqrt();
    /// for time_s in [0.0, 1e-4, 0.003, 0.05, 0.4] {
    ///     let (sin, cos) = (v * time_s).sin_cos();
    ///     let expected = (-0.5 * d * time_s).exp() * (cos + 0.5 * d / v * sin);
    ///     assert!((line.after(pushed, time_s, 0.0).above_reservoir_kpa - expected).abs() < 1e-12);
    /// }
    /// // Under a constant flow the line carries it in the end.
    /// assert!((line.after(pushed, 5.0, 2.0).flow_ml_s - 2.0).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn after(&self, state: LineState, time_s: f64, flow_ml_s: f64) -> LineState {
        let oscillator = Oscillator::new(self, Port::Outlet);
        let before = oscillator.balanced(state.numbers());
        LineState::of(oscillator.physical(oscillator.after(time_s, before, &Flow::even(flow_ml_s))))
    }
}
