//! States of a line at equal intervals from one state on, all at once.

use crate::motion::flow::{DEGREE, Flow};

use super::oscillator::{Balanced, Oscillator};
use super::propagator::{Propagator, RECIPROCALS};

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
        let mut before = 0.0;
        for row in &mut reach.effects {
            let [row_x, row_y] = row;
            for lane in 0..LANES {
                for (effect, (x, y)) in effects.iter().zip(row_x.iter_mut().zip(row_y.iter_mut())) {
                    (x[lane], y[lane]) = (effect[0], effect[1]);
                }
                for (cause, effect) in effects.iter_mut().enumerate() {
                    *effect = one.moved(*effect);
                    let Some(k) = cause.checked_sub(2) else {
                        continue;
                    };
                    // A flow t^k is sum_j C(k, j) n^(k-j) (t - n)^j, counted from n intervals on.
                    let mut weight = 1.0;
                    let responses = one.response.iter().enumerate().take(k + 1).rev();
                    for ((j, [x, y]), reciprocal) in responses.zip(RECIPROCALS.iter().skip(1)) {
                        *effect = [effect[0] + weight * x, effect[1] + weight * y];
                        weight *= before * j as f64 * reciprocal;
                    }
                }
                before += 1.0;
            }
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

    /// Returns the pressures row by row, kPa.
    #[inline]
    pub(crate) fn kpa(&self, causes: Causes<C>) -> impl Iterator<Item = [f64; LANES]> {
        self.effects.iter().map(move |[x, _]| sums(x, &causes))
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

/// Returns the sums of all effects by lane.
#[inline(always)]
pub(crate) fn sums<const C: usize>(row: &Row<C>, causes: &Causes<C>) -> [f64; LANES] {
    let mut sums = [0.0; LANES];
    let mut add = |causes: &[f64], row: &[[f64; LANES]]| {
        for (effects, cause) in row.iter().zip(causes) {
            for (sum, effect) in sums.iter_mut().zip(effects) {
                *sum += effect * cause;
            }
        }
    };
    let ((even, rest), (even_row, rest_row)) = (causes.split_at(EVEN), row.split_at(EVEN));
    add(even, even_row);
    // Between the pulses of two rollers the flow is even.
    if rest.iter().any(|cause| *cause != 0.0) {
        add(rest, rest_row);
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
    // The quotient may round over a sample.
    let mut count = (((end_s - time_s(0)) / dt_s) as usize).clamp(1, most);
    while count > 1 && time_s(count - 1) > end_s {
        count -= 1;
    }
    while count < most && time_s(count) <= end_s {
        count += 1;
    }
    count
}
