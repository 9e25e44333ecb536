//! Short steps of an augmented state, by Taylor series whose terms are computed once for a line.

use crate::line::oscillator::{Balanced, Oscillator, SHORT};
use crate::line::propagator::{RECIPROCALS, TERMS, product};
use crate::motion::flow::DEGREE;

use super::augmented::{ANGLE, Augmented, ByLine, Flows, LINE, ROLLER};

/// Degree of the flow at constant speed.
const CONSTANT_SPEED: usize = 4;

/// A matrix by columns and its derivatives by R, C and L, one after the other.
const MATRICES: usize = 4 * (1 + LINE);
/// A state and its derivatives by R, C and L, one after the other.
const RESPONSES: usize = 2 * (1 + LINE);

/// Terms of the series in x = |A| h of steps of any length h with x up to [`SHORT`].
#[derive(Debug, Clone)]
pub(super) struct ShortSteps {
    /// Terms of (e^(A h) - I)/x and of its derivatives.
    change: [[f64; MATRICES]; TERMS],
    constant_speed: Response,
    accelerated: Response,
}

/// Terms of the response to a flow t^degree and of its derivatives, over h^(degree + 1).
#[derive(Debug, Clone)]
struct Response {
    degree: usize,
    terms: [[f64; RESPONSES]; TERMS],
}

impl ShortSteps {
    pub(super) fn new(oscillator: &Oscillator) -> Self {
        let per_norm = 1.0 / oscillator.norm();
        let mut change = [[0.0; MATRICES]; TERMS];
        let mut columns = [[1.0, 0.0], [0.0, 1.0]];
        let mut by_columns = [[[0.0; 2]; LINE]; 2];
        for (terms, reciprocal) in change.iter_mut().zip(RECIPROCALS.iter().skip(1)) {
            let factor = per_norm * reciprocal;
            for (k, (column, by_column)) in columns.iter_mut().zip(&mut by_columns).enumerate() {
                (*column, *by_column) = oscillator.next_term(factor, *column, by_column);
                [terms[2 * k], terms[2 * k + 1]] = *column;
                for (n, by) in by_column.iter().enumerate() {
                    [terms[4 * (n + 1) + 2 * k], terms[4 * (n + 1) + 2 * k + 1]] = *by;
                }
            }
        }
        let response = |degree| Response::new(oscillator, per_norm, degree);
        Self { change, constant_speed: response(CONSTANT_SPEED), accelerated: response(DEGREE) }
    }

    /// Returns the augmented state `h` after `state`. The flows count time from there.
    pub(super) fn after(
        &self,
        oscillator: &Oscillator,
        h: f64,
        state: &Augmented,
        flows: &Flows,
    ) -> Augmented {
        let x = oscillator.norm() * h;
        let count = terms_for(x);
        let change = summed(&self.change, count, x).map(|sum| x * sum);
        let (matrices, _) = change.as_chunks::<4>();
        let mut after = *state;
        let mut by_line = after.iter_mut();
        for (n, after) in by_line.by_ref().enumerate() {
            let Some([a, b, c, d]) = matrices.first() else { break };
            let own = product(&[[*a, *b], [*c, *d]], *after);
            let by = match matrices.get(n).filter(|_| n > 0) {
                Some([a, b, c, d]) => product(&[[*a, *b], [*c, *d]], state[0]),
                None => [0.0; 2],
            };
            *after = [after[0] + (own[0] + by[0]), after[1] + (own[1] + by[1])];
        }
        let response =
            if flows.line.degree <= CONSTANT_SPEED { &self.constant_speed } else { &self.accelerated };
        response.add_to(&mut after, oscillator, (h, x, count), flows);
        after
    }
}

impl Response {
    /// Sums A^n b degree!/(n + degree + 1)!, in units of |A|^n.
    fn new(oscillator: &Oscillator, per_norm: f64, degree: usize) -> Self {
        let mut term = [oscillator.rate * oscillator.impedance, 0.0];
        let mut by_term = by_input(term);
        let mut terms = [[0.0; RESPONSES]; TERMS];
        // The weights degree!/(n + degree + 1)!.
        let mut weight = RECIPROCALS[degree + 1];
        for (place, reciprocal) in terms.iter_mut().zip(RECIPROCALS.iter().skip(degree + 2)) {
            let (places, _) = place.as_chunks_mut::<2>();
            for (place, term) in places.iter_mut().zip(core::iter::once(&term).chain(&by_term)) {
                *place = term.map(|x| weight * x);
            }
            weight *= reciprocal;
            (term, by_term) = oscillator.next_term(per_norm, term, &by_term);
        }
        Self { degree, terms }
    }

    /// Adds the responses to the flows over a step of `h`.
    ///
    /// The response r_k to a flow t^k follows from the next one: k r_(k-1) = A r_k + b h^k.
    fn add_to(
        &self,
        after: &mut Augmented,
        oscillator: &Oscillator,
        (h, x, count): (f64, f64, usize),
        flows: &Flows,
    ) {
        let mut powers = [1.0; DEGREE + 2];
        for n in 1..DEGREE + 2 {
            powers[n] = powers[n - 1] * h;
        }
        let last = powers[self.degree + 1];
        let [rx, ry, by @ ..] = summed(&self.terms, count, x).map(|sum| last * sum);
        let mut response = [rx, ry];
        let (pairs, _) = by.as_chunks::<2>();
        let mut by_response = [[0.0; 2]; LINE];
        by_response.copy_from_slice(pairs);
        let input = oscillator.rate * oscillator.impedance;
        for k in (0..=self.degree).rev() {
            let add = |to: &mut Balanced, flow: f64, response: Balanced| {
                *to = [to[0] + flow * response[0], to[1] + flow * response[1]];
            };
            let [state, by_line @ .., _, _] = &mut *after;
            add(state, flows.line.c[k], response);
            for (to, response) in by_line.iter_mut().zip(by_response) {
                add(to, flows.line.c[k], response);
            }
            add(&mut after[ANGLE], flows.by_angle.c[k], response);
            add(&mut after[ROLLER], flows.by_roller.c[k], response);
            let reciprocal = RECIPROCALS[k];
            let mut rate = oscillator.times(response);
            rate[0] += input * powers[k];
            let by_line = oscillator.by_line(response, rate);
            for (by, e) in by_response.iter_mut().zip(by_line) {
                let next = oscillator.times(*by);
                *by = [reciprocal * (next[0] + e[0]), reciprocal * (next[1] + e[1])];
            }
            response = rate.map(|x| reciprocal * x);
        }
    }
}

impl Oscillator {
    /// Returns `factor` A z and its derivatives, of z and its derivatives.
    pub(super) fn next_term(
        &self,
        factor: f64,
        term: Balanced,
        by_term: &ByLine<Balanced>,
    ) -> (Balanced, ByLine<Balanced>) {
        let rate = self.times(term);
        let mut by_next = self.by_line(term, rate);
        for (by_next, by) in by_next.iter_mut().zip(by_term) {
            let next = self.times(*by);
            *by_next = [factor * (next[0] + by_next[0]), factor * (next[1] + by_next[1])];
        }
        (rate.map(|x| factor * x), by_next)
    }
}

/// Returns the derivatives of the input b by R, C and L: b is in proportion to 1/C.
pub(super) fn by_input(input: Balanced) -> ByLine<Balanced> {
    [[0.0; 2], input.map(|x| -x), [0.0; 2]]
}

/// Returns the sum of the first `count` terms times the powers of x, by Horner's rule.
fn summed<const K: usize>(terms: &[[f64; K]; TERMS], count: usize, x: f64) -> [f64; K] {
    let mut sum = [0.0; K];
    for terms in terms.iter().take(count).rev() {
        for (sum, term) in sum.iter_mut().zip(terms) {
            *sum = *sum * x + term;
        }
    }
    sum
}

/// Returns the number of terms after which a series in x is below rounding. Term n of a derivative is at most
/// x^n/(n - 1)! of the state.
fn terms_for(x: f64) -> usize {
    let (mut bound, mut terms) = (1.0, 1);
    while bound > 1e-18 && terms < TERMS {
        bound *= x * RECIPROCALS[terms];
        terms += 1;
    }
    terms
}

/// True if a step of `h` is short for the line.
pub(super) fn is_short(oscillator: &Oscillator, h: f64) -> bool {
    oscillator.norm() * h <= SHORT
}
