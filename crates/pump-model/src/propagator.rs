//! The exact solution of a line over a time in which the flow at the rollers is a polynomial.
//!
//! Between two edges the model is linear with polynomial forcing, z' = A z + b f(t), so that
//! z(h) = e^(A h) z(0) + integral of e^(A (h - t)) b f(t) dt. Two ways to sum it, both exact to rounding:
//! the Taylor series of z over a short step, and over a long one matrices for a short step, doubled until it is long
//! enough (scaling and squaring, after Higham, "Functions of Matrices", chapter 10). Neither divides by A, so slow,
//! stiff, critically damped and undamped lines are one case.

use crate::flow_curve::Port;
use crate::hermite::{self, End};
use crate::line::Line;
use crate::math::sqrt;
use crate::polynomial::{Polynomial, shift_coefficients};

/// Highest degree of the flow over time: a quartic in the angle, which is quadratic in time, times the speed.
pub(crate) const DEGREE: usize = 9;

/// Steps with |A| h up to this are summed by their Taylor series.
pub(crate) const SHORT: f64 = 0.5;

/// Terms of the series: 0.5^17/17! is below rounding.
const TERMS: usize = 17;

/// Flow at the rollers over time, as a polynomial in time since some instant, lowest order first, mL/s^(n+1).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Flow {
    pub(crate) c: [f64; DEGREE + 1],
    /// Coefficients beyond this are zero.
    pub(crate) degree: usize,
}

impl Flow {
    /// Value at `t`.
    pub(crate) fn at(&self, t: f64) -> f64 {
        self.terms().rev().fold(0.0, |sum, c| sum * t + c)
    }

    /// The polynomial in time since `t`.
    pub(crate) fn shifted(&self, t: f64) -> Self {
        let mut shifted = *self;
        let count = shifted.c.len().min(self.degree + 1);
        shift_coefficients(&mut shifted.c[..count], t);
        shifted
    }

    /// Derivative at `t`.
    pub(crate) fn rate_at(&self, t: f64) -> f64 {
        self.terms().enumerate().skip(1).rev().fold(0.0, |sum, (n, c)| sum * t + n as f64 * c)
    }

    /// Its coefficients but the zeros beyond its degree.
    fn terms(&self) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator {
        self.c.into_iter().take(self.degree + 1)
    }
}

/// A line in coordinates in which both states carry energy alike: x = p, y = Q_L z with z = sqrt(L/C).
///
/// With s = 1 at the outlet and -1 at the inlet and w = 1/sqrt(L C), the circuit of `circuit.rs` reads
/// dx/dt = s w (z f - y), dy/dt = s w x - (R/L) y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Oscillator {
    /// s w, rad/s.
    pub(crate) rate: f64,
    /// R/L, 1/s.
    pub(crate) decay: f64,
    /// z, kPa s/mL.
    impedance: f64,
    /// 1/z, mL/(s kPa).
    admittance: f64,
}

/// (x, y) of an [`Oscillator`], kPa.
pub(crate) type Balanced = [f64; 2];

impl Oscillator {
    pub(crate) fn new(line: &Line, port: Port) -> Self {
        let sign = match port {
            Port::Inlet => -1.0,
            Port::Outlet => 1.0,
        };
        Self {
            rate: sign * line.natural_rad_s(),
            decay: line.resistance_kpa_s_ml / line.inertance_kpa_s2_ml,
            impedance: sqrt(line.inertance_kpa_s2_ml / line.compliance_ml_kpa),
            admittance: sqrt(line.compliance_ml_kpa / line.inertance_kpa_s2_ml),
        }
    }

    /// From (pressure above the reservoir in kPa, flow in mL/s).
    pub(crate) fn balanced(&self, state: [f64; 2]) -> Balanced {
        [state[0], state[1] * self.impedance]
    }

    /// To (pressure above the reservoir in kPa, flow in mL/s).
    #[inline]
    pub(crate) fn physical(&self, state: Balanced) -> [f64; 2] {
        [state[0], state[1] * self.admittance]
    }

    /// Largest rate of change of its states, 1/s: a bound of |A|.
    pub(crate) fn norm(&self) -> f64 {
        self.rate.abs() + self.decay
    }

    /// A z.
    fn times(&self, state: Balanced) -> Balanced {
        [-self.rate * state[1], self.rate * state[0] - self.decay * state[1]]
    }

    /// dz/dt where the flow at the rollers is `flow`.
    pub(crate) fn derivative(&self, state: Balanced, flow: f64) -> Balanced {
        let [x, y] = self.times(state);
        [x + self.rate * self.impedance * flow, y]
    }

    /// Length of a step, s, over which the solution is simple: a fraction of the swing; in an overdamped line a fraction
    /// of its fast mode at first, longer as that dies out over the time `since_s` the last edge, and a sixteenth of the
    /// stretch of `length_s` at most; once every mode has died out only the polynomial is left, in 64 parts.
    pub(crate) fn fine_step_s(&self, since_s: f64, length_s: f64) -> f64 {
        let fast_s = SHORT / self.norm();
        if self.slowest_decay() * since_s > 40.0 {
            (length_s / 64.0).max(fast_s)
        } else if self.decay < 2.0 * self.rate.abs() {
            fast_s
        } else {
            (0.3 * since_s).min(length_s / 16.0).max(fast_s)
        }
    }

    /// Pressures at which it turns within `length_s` after `before`, kPa, by way of `found`.
    ///
    /// Over a step short beside the swing the quintic polynomial through both ends shows the turns and Newton's method
    /// on dp/dt, whose derivative is known, places them; over a longer one, where only slow parts are left, a change of
    /// sign of dp/dt is bisected. What is left of the error of the place counts in second order only.
    pub(crate) fn turns(
        &self,
        length_s: f64,
        before: Balanced,
        after: Balanced,
        flow: &Flow,
        mut found: impl FnMut(f64),
    ) {
        let slope_at = |t| self.derivative(self.after(t, before, flow), flow.at(t))[0];
        if self.norm() * length_s <= 10.0 {
            let slope = self.pressure(length_s, before, after, flow).derivative();
            for turn in slope.roots_in(0.0, 1.0).as_slice() {
                found(self.turning_kpa(turn * length_s, length_s, before, flow));
            }
            return;
        }
        let (first, last) = (slope_at(0.0), self.derivative(after, flow.at(length_s))[0]);
        // Slopes below this are rounding of their two large parts.
        let noise =
            1e-14 * self.norm() * (before[0].abs() + before[1].abs() + after[0].abs() + after[1].abs());
        if first * last >= 0.0 || first.abs().min(last.abs()) < noise {
            return;
        }
        let (mut low, mut high) = (0.0, length_s);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if (slope_at(middle) > 0.0) == (first > 0.0) {
                low = middle;
            } else {
                high = middle;
            }
        }
        found(self.after(low, before, flow)[0]);
    }

    /// Pressure between two states over the fraction of the time passed, 0 to 1; `flow` counts time from `before`.
    pub(crate) fn pressure(
        &self,
        length_s: f64,
        before: Balanced,
        after: Balanced,
        flow: &Flow,
    ) -> Polynomial {
        let end = |state: Balanced, t| {
            let slope = self.derivative(state, flow.at(t));
            let curvature = self.derivative(slope, flow.rate_at(t));
            End { value: state[0], slope: slope[0], curvature: curvature[0] }
        };
        Polynomial { c: hermite::quintic(length_s, &end(before, 0.0), &end(after, length_s)) }
    }

    /// Pressure where it turns near `near_s` after `state`, kPa. Beyond `length_s` the flow is another one: of a turn that
    /// would lie there the end is taken. (In a sliver of a stretch rounding makes such turns.)
    fn turning_kpa(&self, near_s: f64, length_s: f64, state: Balanced, flow: &Flow) -> f64 {
        let mut t = near_s;
        let mut there = self.after(t, state, flow);
        for _ in 0..2 {
            let slope = self.derivative(there, flow.at(t));
            let curvature = self.derivative(slope, flow.rate_at(t));
            let shift = slope[0] / curvature[0];
            // Where the curve is flat there is nothing to gain.
            if shift.is_nan() || shift.abs() >= 0.1 / self.norm() {
                break;
            }
            t = (t - shift).max(0.0).min(length_s);
            there = self.after(t, state, flow);
        }
        there[0]
    }

    /// State `h` after `state`; `flow` counts time from there.
    pub(crate) fn after(&self, h: f64, state: Balanced, flow: &Flow) -> Balanced {
        if self.norm() * h <= SHORT {
            self.series(h, state, flow)
        } else {
            Propagator::new(self, h, flow.degree).apply(state, flow)
        }
    }

    /// z(h) = sum of Z_n with Z_(n+1) = h (A Z_n + b f_n h^n) / (n + 1).
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
            // Beyond the flow's own terms they fall by |A| h / n each.
            if forced.is_none() && term[0].abs() + term[1].abs() <= 1e-18 * (sum[0].abs() + sum[1].abs()) {
                break;
            }
        }
        sum
    }
}

/// 1/n.
const RECIPROCALS: [f64; TERMS + DEGREE + 2] = {
    let mut table = [0.0; TERMS + DEGREE + 2];
    let mut n = 1;
    while n < table.len() {
        table[n] = 1.0 / n as f64;
        n += 1;
    }
    table
};

/// What a time step of fixed length does to the state of an [`Oscillator`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Propagator {
    step_s: f64,
    /// e^(A h) - I: the difference keeps slow modes exact beside fast ones.
    change: [Balanced; 2],
    /// gamma_k: response to a flow of (t/h)^k.
    response: [Balanced; DEGREE + 1],
    degree: usize,
}

impl Propagator {
    /// For steps of `h` and flows of `degree` at most.
    pub(crate) fn new(oscillator: &Oscillator, h: f64, degree: usize) -> Self {
        // 2^1100 times shorter than any finite step is short.
        let mut doublings = 0;
        let mut short = h;
        while oscillator.norm() * short > SHORT && doublings < 1100 {
            short *= 0.5;
            doublings += 1;
        }
        let mut propagator = Self::short(oscillator, short, degree);
        for _ in 0..doublings {
            propagator.double();
        }
        // Halving and doubling are exact, so this is h.
        propagator.step_s = h;
        propagator
    }

    /// Taylor series: e^(A h) - I = sum A^n h^n / n!, gamma_k = sum A^n b h^(n+1) k!/(n+k+1)!.
    fn short(oscillator: &Oscillator, h: f64, degree: usize) -> Self {
        let mut change = [[0.0; 2]; 2];
        let mut columns = [[1.0, 0.0], [0.0, 1.0]];
        let mut response = [[0.0; 2]; DEGREE + 1];
        let mut input = [h * oscillator.rate * oscillator.impedance, 0.0];
        // k!/(n+k)!, starting at n = 1.
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

    /// The same for twice the step: F' = 2 F + F², gamma_k' = (e^(A h) gamma_k + sum_j C(k, j) gamma_j) / 2^k.
    fn double(&mut self) {
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

    /// (e^(A h) - I) z.
    fn changed(&self, state: Balanced) -> Balanced {
        let [first, second] = self.change;
        [first[0] * state[0] + second[0] * state[1], first[1] * state[0] + second[1] * state[1]]
    }

    /// e^(A h) z.
    pub(crate) fn moved(&self, state: Balanced) -> Balanced {
        let change = self.changed(state);
        [state[0] + change[0], state[1] + change[1]]
    }

    /// State a step after `state`; `flow` counts time from there.
    pub(crate) fn apply(&self, state: Balanced, flow: &Flow) -> Balanced {
        let mut sum = self.moved(state);
        let mut power = 1.0;
        for (c, response) in flow.c.iter().zip(&self.response).take(flow.degree.min(self.degree) + 1) {
            sum = [sum[0] + power * c * response[0], sum[1] + power * c * response[1]];
            power *= self.step_s;
        }
        sum
    }

    /// e^(A h) - I by columns.
    pub(crate) fn change(&self) -> [Balanced; 2] {
        self.change
    }

    /// What a flow of degree 4 adds to both states over a step that starts at `t`, as polynomials in t:
    /// sum_k gamma_k h^k f^(k)(t)/k!.
    pub(crate) fn input(&self, flow: &Flow) -> [[f64; 5]; 2] {
        let mut inputs = [[0.0; 5]; 2];
        let [pressure, line_flow] = &mut inputs;
        for (j, (p, q)) in pressure.iter_mut().zip(line_flow).enumerate() {
            let mut weight = 1.0; // C(j + k, k) h^k
            for k in 0..5 - j {
                let c = weight * flow.c[j + k];
                *p += c * self.response[k][0];
                *q += c * self.response[k][1];
                weight *= (j + k + 1) as f64 * RECIPROCALS[k + 1] * self.step_s;
            }
        }
        inputs
    }
}
