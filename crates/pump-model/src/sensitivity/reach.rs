//! States with derivatives at equal intervals from one state on, all at once.

use crate::line::oscillator::{Balanced, Oscillator};
use crate::line::propagator::{RECIPROCALS, product};
use crate::line::reach::{CAUSES, Causes, LANES, Reach, Row, sums};

use super::augmented::{ANGLE, Augmented, ByLine, Flows, LINE, ROLLER, STATES};
use super::propagator::SensitivePropagator;

/// Effect of each cause on the states with derivatives n intervals on, n = 0, 1, 2 ..., in `ROWS` rows of lanes.
#[derive(Debug, Clone)]
pub(super) struct SensitiveReach<const ROWS: usize> {
    line: Reach<ROWS>,
    /// Derivatives of the effects on x and y by R, C and L.
    slopes: [ByLine<[Row; 2]>; ROWS],
}

/// All that decides the states with derivatives: the state and the flow of the line, the state of each derivative, and
/// the flows that drive those by the angle and the roller volume.
#[derive(Debug, Clone, Copy)]
pub(super) struct SensitiveCauses {
    line: Causes,
    by_line: ByLine<Balanced>,
    by_angle: Causes,
    by_roller: Causes,
}

impl<const ROWS: usize> SensitiveReach<ROWS> {
    pub(super) fn new(oscillator: &Oscillator, dt_s: f64) -> Self {
        let line = Reach::new(oscillator, dt_s);
        let one = SensitivePropagator::new(oscillator, dt_s, 4);
        let (changes, responses) = (one.decay_by_line(), one.responses_by_line());
        let mut slopes = [[[[[0.0; LANES]; CAUSES]; 2]; LINE]; ROWS];
        for (n, (change, response)) in changes.iter().zip(responses).enumerate() {
            let mut effects = [[0.0; 2]; CAUSES];
            for lane in 0..ROWS * LANES {
                let [row_x, row_y] = &mut slopes[lane / LANES][n];
                for (effect, (x, y)) in effects.iter().zip(row_x.iter_mut().zip(row_y)) {
                    (x[lane % LANES], y[lane % LANES]) = (effect[0], effect[1]);
                }
                // The product rule over one interval more.
                for (cause, effect) in effects.iter_mut().enumerate() {
                    let (moved, by) = (one.moved(*effect), product(change, line.effect(lane, cause)));
                    *effect = [moved[0] + by[0], moved[1] + by[1]];
                    let Some(k) = cause.checked_sub(2) else {
                        continue;
                    };
                    let mut weight = 1.0; // C(k, j) n^(k-j), see `Reach`
                    for j in (0..=k).rev() {
                        *effect = [effect[0] + weight * response[j][0], effect[1] + weight * response[j][1]];
                        weight *= lane as f64 * j as f64 * RECIPROCALS[k - j + 1];
                    }
                }
            }
        }
        Self { line, slopes }
    }

    /// Returns the causes of states from `state` on. The flows, of degree 4 at most, count time from `since_s` before.
    pub(super) fn causes(&self, state: &Augmented, flows: &Flows, since_s: f64) -> SensitiveCauses {
        let [z, by_resistance, by_compliance, by_inertance, by_angle, by_roller] = *state;
        SensitiveCauses {
            line: self.line.causes(z, &flows.line, since_s),
            by_line: [by_resistance, by_compliance, by_inertance],
            by_angle: self.line.causes(by_angle, &flows.by_angle, since_s),
            by_roller: self.line.causes(by_roller, &flows.by_roller, since_s),
        }
    }

    /// Returns the pressures and their derivatives row by row, kPa in the units of [`Augmented`].
    #[inline]
    pub(super) fn kpa(&self, causes: SensitiveCauses) -> impl Iterator<Item = [[f64; LANES]; STATES]> {
        self.line.rows().iter().zip(&self.slopes).map(move |([effects, _], slopes)| {
            let mut kpa = [[0.0; LANES]; STATES];
            kpa[0] = sums(effects, &causes.line);
            for (kpa, ([slope, _], own)) in kpa.iter_mut().skip(1).zip(slopes.iter().zip(&causes.by_line)) {
                *kpa = sums(slope, &causes.line);
                for (lane, kpa) in kpa.iter_mut().enumerate() {
                    *kpa += effects[0][lane] * own[0] + effects[1][lane] * own[1];
                }
            }
            kpa[ANGLE] = sums(effects, &causes.by_angle);
            kpa[ROLLER] = sums(effects, &causes.by_roller);
            kpa
        })
    }

    /// Returns the second states y of the line row by row, kPa, see [`Oscillator`].
    #[inline]
    pub(super) fn second_kpa(&self, causes: SensitiveCauses) -> impl Iterator<Item = [f64; LANES]> {
        self.line.rows().iter().map(move |[_, effects]| sums(effects, &causes.line))
    }

    /// Returns the state with derivatives `n` intervals on. There must be a lane for it.
    pub(super) fn state(&self, n: usize, causes: &SensitiveCauses) -> Augmented {
        let mut state = [[0.0; 2]; STATES];
        state[0] = self.line.state(n, &causes.line);
        for (p, (state, own)) in state.iter_mut().skip(1).zip(&causes.by_line).enumerate() {
            for (row, state) in state.iter_mut().enumerate() {
                let slope = &self.slopes[n / LANES][p][row];
                let by = slope
                    .iter()
                    .zip(&causes.line)
                    .fold(0.0, |sum, (effect, cause)| sum + effect[n % LANES] * cause);
                *state = by + self.line.effect(n, 0)[row] * own[0] + self.line.effect(n, 1)[row] * own[1];
            }
        }
        state[ANGLE] = self.line.state(n, &causes.by_angle);
        state[ROLLER] = self.line.state(n, &causes.by_roller);
        state
    }
}
