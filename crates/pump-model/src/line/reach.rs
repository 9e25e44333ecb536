//! States of a line at equal intervals from one state on, all at once.

use crate::motion::flow::{DEGREE, Flow};

use super::oscillator::{Balanced, Oscillator};
use super::propagator::{Propagator, RECIPROCALS, product};

/// Number of what decides the states at constant speed: the first one's two parts, and the coefficients of a flow of
/// degree 4.
pub(crate) const CAUSES: usize = 7;

/// Number of what decides the states at any speed: the first one's two parts, and the coefficients of any flow.
pub(crate) const ALL_CAUSES: usize = DEGREE + 3;

/// Number of causes where the flow does not change.
const EVEN: usize = 3;

/// Number of states that are computed together, each in a lane of its own.
pub(crate) const LANES: usize = 8;

/// A state's two parts, and the coefficients of the flow in powers of the interval.
pub(crate) type Causes<const C: usize = CAUSES> = [f64; C];

/// Effects of every cause on the lanes of a row.
pub(crate) type Row<const C: usize = CAUSES> = [[f64; LANES]; C];

/// Effect of each of `C` causes on the states n intervals on, n = 0, 1, 2 ..., in `ROWS` rows of lanes.
#[derive(Debug, Clone)]
pub(crate) struct Reach<const ROWS: usize, const C: usize = CAUSES> {
    /// Effects on the states x, the pressure, and y.
    effects: [[Row<C>; 2]; ROWS],
    /// Powers of the interval, s^n, from 0 on.
    powers_s: [f64; DEGREE + 1],
}

impl<const ROWS: usize, const C: usize> Reach<ROWS, C> {
    pub(crate) fn new(oscillator: &Oscillator, dt_s: f64) -> Self {
        let one = Propagator::new(oscillator, dt_s, C - 3);
        // Effects after n intervals: of the state's two parts, and of flows (t/dt)^k.
        let mut effects = [[0.0; 2]; C];
        (effects[0][0], effects[1][1]) = (1.0, 1.0);
        let mut powers_s = [1.0; DEGREE + 1];
        let mut power_s = 1.0;
        for place in &mut powers_s {
            *place = power_s;
            power_s *= dt_s;
        }
        let mut reach = Self { effects: [[[[0.0; LANES]; C]; 2]; ROWS], powers_s };
        let Some((first, rest)) = reach.effects.split_first_mut() else {
            return reach;
        };
        let [first_x, first_y] = &mut *first;
        for lane in 0..LANES {
            for (effect, (x, y)) in effects.iter().zip(first_x.iter_mut().zip(first_y.iter_mut())) {
                (x[lane], y[lane]) = (effect[0], effect[1]);
            }
            for (cause, effect) in effects.iter_mut().enumerate() {
                *effect = one.moved(*effect);
                for (j, weight) in weights(cause, lane as f64) {
                    if let Some([x, y]) = one.response.get(j) {
                        *effect = [effect[0] + weight * x, effect[1] + weight * y];
                    }
                }
            }
        }
        let per_row = effects;
        let mut before = 0.0;
        for row in rest {
            before += LANES as f64;
            for (lanes, first) in row.iter_mut().zip(&*first) {
                continue_row(first, &effects, before, lanes);
            }
            effects = continued(&per_row, &effects, before);
        }
        reach
    }

    /// Returns the interval, s.
    pub(crate) fn interval_s(&self) -> f64 {
        self.powers_s[1]
    }

    /// Returns the effects on x and y row by row.
    #[cfg(feature = "sensitivity")]
    pub(crate) fn rows(&self) -> &[[Row<C>; 2]; ROWS] {
        &self.effects
    }

    /// Returns the effect of a cause on the state `n` intervals on. There must be a lane for it.
    #[cfg(feature = "sensitivity")]
    pub(crate) fn effect(&self, n: usize, cause: usize) -> Balanced {
        let [x, y] = &self.effects[n / LANES];
        [x[cause][n % LANES], y[cause][n % LANES]]
    }

    /// Writes the pressures row by row, kPa, each `base_kpa` higher. The excess of a longer slice is left as it is.
    #[inline]
    pub(crate) fn write_kpa(&self, causes: &Causes<C>, base_kpa: f64, kpa: &mut [[f64; LANES]]) {
        for (kpa, [row, _]) in kpa.iter_mut().zip(&self.effects) {
            *kpa = sums(row, causes).map(|sum| sum + base_kpa);
        }
    }

    /// Returns the states row by row, kPa.
    #[inline]
    pub(crate) fn states(&self, causes: Causes<C>) -> impl Iterator<Item = [[f64; LANES]; 2]> {
        self.effects.iter().map(move |[x, y]| [sums(x, &causes), sums(y, &causes)])
    }

    /// Returns the state `n` intervals on. There must be a lane for it.
    #[inline]
    pub(crate) fn state(&self, n: usize, causes: &Causes<C>) -> Balanced {
        let Some([x, y]) = self.effects.get(n / LANES) else {
            return [0.0; 2];
        };
        let sum = |row: &Row<C>| {
            row.iter().zip(causes).fold(0.0, |sum, (effect, cause)| sum + effect[n % LANES] * cause)
        };
        [sum(x), sum(y)]
    }
}

impl<const ROWS: usize> Reach<ROWS> {
    /// Returns the causes of states from `state` on. `flow`, of degree 4 at most, counts time from `since_s` before.
    #[inline]
    pub(crate) fn causes(&self, [x, y]: Balanced, flow: &Flow, since_s: f64) -> Causes {
        let ([c0, c1, c2, c3, c4], t) = (flow.quartic_after(since_s), &self.powers_s);
        [x, y, c0, c1 * t[1], c2 * t[2], c3 * t[3], c4 * t[4]]
    }
}

impl<const ROWS: usize> Reach<ROWS, ALL_CAUSES> {
    /// Returns the causes of states from `state` on. `flow` counts time from there.
    pub(crate) fn all_causes(&self, [x, y]: Balanced, flow: &Flow) -> Causes<ALL_CAUSES> {
        let mut causes = [0.0; ALL_CAUSES];
        (causes[0], causes[1]) = (x, y);
        for (cause, (c, power)) in causes.iter_mut().skip(2).zip(flow.c.iter().zip(self.powers_s)) {
            *cause = power * c;
        }
        causes
    }
}

/// Returns the orders j of the flows (t - n)^j that make up the flow t^k of a cause, and the weight of each: t^k is
/// sum_j C(k, j) n^(k-j) (t - n)^j. A cause that is no flow has none.
fn weights(cause: usize, n: f64) -> impl Iterator<Item = (usize, f64)> {
    let mut weight = 1.0;
    (0..cause.saturating_sub(1)).rev().zip(RECIPROCALS.iter().skip(1)).map(move |(j, reciprocal)| {
        let now = weight;
        weight *= n * j as f64 * reciprocal;
        (j, now)
    })
}

/// Writes the effects on a row of one state, x or y, that follows the `effects` after `n` intervals. In the `first` row
/// they are those from the start on.
fn continue_row<const C: usize>(first: &Row<C>, effects: &[Balanced; C], n: f64, row: &mut Row<C>) {
    let [by_x, by_y, by_flow @ ..] = first.as_slice() else {
        return;
    };
    for (cause, (row, [x, y])) in row.iter_mut().zip(effects).enumerate() {
        for (effect, (by_x, by_y)) in row.iter_mut().zip(by_x.iter().zip(by_y)) {
            *effect = by_x * x + by_y * y;
        }
        for (j, weight) in weights(cause, n) {
            for (effect, by_flow) in row.iter_mut().zip(by_flow.get(j).into_iter().flatten()) {
                *effect += weight * by_flow;
            }
        }
    }
}

/// Returns the effects a row after those after `n` intervals. After the first row they are `per_row`.
fn continued<const C: usize>(per_row: &[Balanced; C], effects: &[Balanced; C], n: f64) -> [Balanced; C] {
    let mut continued = *effects;
    let [by_x, by_y, by_flow @ ..] = per_row.as_slice() else {
        return continued;
    };
    for (cause, effect) in continued.iter_mut().enumerate() {
        *effect = product(&[*by_x, *by_y], *effect);
        for (j, weight) in weights(cause, n) {
            if let Some([x, y]) = by_flow.get(j) {
                *effect = [effect[0] + weight * x, effect[1] + weight * y];
            }
        }
    }
    continued
}

/// Returns the sums of all effects by lane.
#[inline(always)]
pub(crate) fn sums<const C: usize>(row: &Row<C>, causes: &Causes<C>) -> [f64; LANES] {
    let ((even, rest), (even_row, rest_row)) = (causes.split_at(EVEN), row.split_at(EVEN));
    let mut effects = even_row.iter().zip(even);
    // A sum that began at 0 would cost one more addition, where there are three.
    let first = effects.next().map_or([0.0; LANES], |(effects, cause)| effects.map(|effect| effect * cause));
    let sums = effects.fold(first, added);
    // Between the pulses of two rollers the flow is even.
    if rest.iter().all(|cause| *cause == 0.0) { sums } else { rest_row.iter().zip(rest).fold(sums, added) }
}

/// Returns the sums by lane and the effects of one more cause.
#[inline(always)]
fn added(mut sums: [f64; LANES], (effects, cause): (&[f64; LANES], &f64)) -> [f64; LANES] {
    for (sum, effect) in sums.iter_mut().zip(effects) {
        *sum += effect * cause;
    }
    sums
}

/// Returns the number of samples up to `end_s`, `most` at most, of which the first lies there or before. Sample n is at
/// `time_s(n)`, `dt_s` after the one before.
#[inline]
pub(crate) fn reached(most: usize, end_s: f64, dt_s: f64, time_s: impl Fn(usize) -> f64) -> usize {
    if time_s(most) <= end_s {
        return most;
    }
    let near = (((end_s - time_s(0)) / dt_s) as usize).clamp(1, most);
    // The quotient may round over a sample. Sums do in place of branches, whose outcome is hard to predict.
    let inside = [near - 1, near, near + 1].map(|n| usize::from(time_s(n) <= end_s));
    (near - 1 + inside.into_iter().sum::<usize>()).clamp(1, most)
}
