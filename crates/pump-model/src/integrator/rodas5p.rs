//! The steps of RODAS5P: error control, stops, statistics.

use nalgebra::{SMatrix, SVector};
use thiserror::Error;

use super::Ode;
use super::dense::DenseStep;
use super::lu::Lu;
use super::tableau::{A, ALPHA, C, GAMMA, GAMMA_I, STAGES};
use crate::math::pow;

/// How exactly to integrate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options<const N: usize> {
    /// Error allowed in a step, relative to each state. Zero or more.
    pub relative: SVector<f64, N>,
    /// Error allowed in a step, in the units of each state. Positive.
    pub absolute: SVector<f64, N>,
    /// Longest step, s; infinite by default.
    pub max_step_s: f64,
}

impl<const N: usize> Options<N> {
    /// The same tolerance for every state, relative and absolute.
    pub fn uniform(tolerance: f64) -> Self {
        Self {
            relative: SVector::repeat(tolerance),
            absolute: SVector::repeat(tolerance),
            max_step_s: f64::INFINITY,
        }
    }
}

/// What an integration cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statistics {
    /// Accepted steps.
    pub steps: u32,
    /// Steps tried again with a shorter length.
    pub rejections: u32,
    /// Matrices factored: one a step that was tried.
    pub factorisations: u32,
    /// Evaluations of f.
    pub evaluations: u32,
}

/// Why an integration stopped.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum IntegrationError {
    /// The state or its derivative is not a finite number.
    #[error("the state is not finite at t = {time_s} s")]
    NotFinite {
        /// When, s.
        time_s: f64,
    },
    /// The tolerance cannot be met by any step.
    #[error("the step size underflows at t = {time_s} s; loosen the tolerance")]
    StepUnderflow {
        /// When, s.
        time_s: f64,
    },
    /// A tolerance that no method can meet.
    #[error("integration tolerance {tolerance:e}; allowed: 1e-13 to 0.1")]
    Tolerance {
        /// What was asked.
        tolerance: f64,
    },
}

/// Order of the error estimate plus one: k_8 is of order h^5.
const ERROR_ORDER: f64 = 5.0;
const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;
const GROW: f64 = 6.0;

/// RODAS5P: linearly implicit, order 5(4), eight stages, one factorisation a step, L-stable.
#[derive(Debug, Clone)]
pub struct Rodas5p<const N: usize> {
    time_s: f64,
    state: SVector<f64, N>,
    options: Options<N>,
    /// Length that the error control asks for. A step clipped by a stop does not change it.
    proposed_s: f64,
    statistics: Statistics,
}

impl<const N: usize> Rodas5p<N> {
    /// Starts at `time_s` in `state`.
    pub fn new(time_s: f64, state: SVector<f64, N>, options: Options<N>) -> Self {
        Self { time_s, state, options, proposed_s: 0.0, statistics: Statistics::default() }
    }

    /// Time reached, s.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// State at that time.
    pub fn state(&self) -> SVector<f64, N> {
        self.state
    }

    /// Replaces the state, as an impulse does.
    pub fn set_state(&mut self, state: SVector<f64, N>) {
        self.state = state;
    }

    /// What it has cost so far.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Makes one accepted step that ends at `stop_s` at the latest, and lands on it exactly. `ode` must be smooth
    /// up to there; the next call may bring another one.
    pub fn step(&mut self, ode: &impl Ode<N>, stop_s: f64) -> Result<DenseStep<N>, IntegrationError> {
        let (t, y) = (self.time_s, self.state);
        let slope = ode.derivative(t, &y);
        self.statistics.evaluations += 1;
        if !(finite(&y) && finite(&slope)) {
            return Err(IntegrationError::NotFinite { time_s: t });
        }
        let jacobian = ode.jacobian(t, &y);
        let slope_rate = ode.time_derivative(t, &y);
        let curvature = jacobian * slope + slope_rate;
        if self.proposed_s <= 0.0 {
            self.proposed_s = self.first_step(&slope, &curvature);
        }
        loop {
            let room = stop_s - t;
            let wanted = self.proposed_s.min(self.options.max_step_s);
            // Leave no sliver before the stop that would need a step of its own.
            let clipped = wanted >= room || wanted > 0.999 * room;
            let h = if clipped {
                room
            } else if wanted > 0.5 * room {
                0.5 * room
            } else {
                wanted
            };
            let end_s = if clipped { stop_s } else { t + h };
            if end_s <= t {
                return Err(IntegrationError::StepUnderflow { time_s: t });
            }
            let h = end_s - t;

            let trial = self.trial(ode, t, &y, &slope, &slope_rate, &jacobian, h);
            let error = trial.map_or(f64::INFINITY, |(next, estimate)| self.error_norm(&y, &next, &estimate));
            let factor = (SAFETY * pow(error.max(1e-10), -1.0 / ERROR_ORDER)).clamp(SHRINK, GROW);
            match trial {
                Some((next, _)) if error <= 1.0 => {
                    // A step cut short by a stop or by halving says nothing against the longer one proposed.
                    let grown = h * factor;
                    self.proposed_s = if h < wanted { grown.max(self.proposed_s) } else { grown };
                    self.statistics.steps += 1;
                    self.time_s = end_s;
                    self.state = next;
                    let end_slope = ode.derivative(end_s, &next);
                    self.statistics.evaluations += 1;
                    if !finite(&end_slope) {
                        return Err(IntegrationError::NotFinite { time_s: end_s });
                    }
                    let end_curvature =
                        ode.jacobian(end_s, &next) * end_slope + ode.time_derivative(end_s, &next);
                    return Ok(DenseStep {
                        start_s: t,
                        length_s: h,
                        value: [y, next],
                        slope: [slope, end_slope],
                        curvature: [curvature, end_curvature],
                    });
                }
                _ => {
                    self.statistics.rejections += 1;
                    self.proposed_s = h * factor.min(SAFETY);
                    if t + self.proposed_s <= t {
                        return Err(IntegrationError::StepUnderflow { time_s: t });
                    }
                }
            }
        }
    }

    /// The new value and the error estimate of a step of length `h`; none if the matrix is singular or the result
    /// is not finite.
    #[allow(clippy::too_many_arguments, reason = "what the step knows at its start, all of it used once")]
    fn trial(
        &mut self,
        ode: &impl Ode<N>,
        t: f64,
        y: &SVector<f64, N>,
        slope: &SVector<f64, N>,
        slope_rate: &SVector<f64, N>,
        jacobian: &SMatrix<f64, N, N>,
        h: f64,
    ) -> Option<(SVector<f64, N>, SVector<f64, N>)> {
        self.statistics.factorisations += 1;
        let lu = Lu::new(SMatrix::identity() / (h * GAMMA) - jacobian)?;
        let mut stages = [SVector::<f64, N>::zeros(); STAGES];
        stages[0] = lu.solve(slope + slope_rate * (h * GAMMA_I[0]));
        let mut value = *y;
        for i in 1..STAGES {
            if i <= A.len() {
                value = *y;
                for (weight, stage) in A[i - 1].iter().zip(&stages).take(i) {
                    value += stage * *weight;
                }
            } else {
                value += stages[i - 1];
            }
            let mut right = ode.derivative(t + ALPHA[i] * h, &value);
            self.statistics.evaluations += 1;
            for (weight, stage) in C[i - 1].iter().zip(&stages).take(i) {
                right += stage * (*weight / h);
            }
            if GAMMA_I[i] != 0.0 {
                right += slope_rate * (h * GAMMA_I[i]);
            }
            stages[i] = lu.solve(right);
        }
        let estimate = stages[STAGES - 1];
        let next = value + estimate;
        (finite(&next) && finite(&estimate)).then_some((next, estimate))
    }

    /// Largest error of a state over what is allowed.
    fn error_norm(&self, y: &SVector<f64, N>, next: &SVector<f64, N>, estimate: &SVector<f64, N>) -> f64 {
        let mut largest = 0.0_f64;
        for i in 0..N {
            let allowed = self.options.absolute[i] + self.options.relative[i] * y[i].abs().max(next[i].abs());
            largest = largest.max(estimate[i].abs() / allowed);
        }
        largest
    }

    /// Length of the first step, from the first two derivatives in units of the tolerance (Hairer, Norsett, Wanner,
    /// "Solving ODEs I", section II.4, with the exact second derivative in place of an Euler step).
    fn first_step(&self, slope: &SVector<f64, N>, curvature: &SVector<f64, N>) -> f64 {
        let mut largest = 0.0_f64;
        for i in 0..N {
            let allowed = self.options.absolute[i] + self.options.relative[i] * self.state[i].abs();
            largest = largest.max(slope[i].abs() / allowed).max(curvature[i].abs() / allowed);
        }
        if largest > 0.0 { pow(0.01 / largest, 1.0 / ERROR_ORDER) } else { 1.0 }
    }
}

fn finite<const N: usize>(vector: &SVector<f64, N>) -> bool {
    vector.iter().all(|x| x.is_finite())
}
