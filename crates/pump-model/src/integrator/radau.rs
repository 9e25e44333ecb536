//! Steps of Radau's method for linear equations: error control, stops, statistics.

use libm::{ceil, sqrt};
use nalgebra::{SMatrix, SVector};

use crate::error::IntegrationError;

use super::complex::Complex;
use super::dense::DenseStep;
use super::lu::Lu;
use super::ode::Ode;
use super::options::{Options, Statistics};
use super::radau_tableau::{COMPLEX, END, INSIDE, INTO, NODES, OUT, PAIRS, REAL, STAGES};
use super::rodas5p::{LONGEST_STEP_S, entries, finite};

/// Safety factor of the step length. The error estimate is of order h^8, so a step is scaled by the eighth root of the
/// error.
const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;
const GROW: f64 = 6.0;

/// Weight of the error inside a step. RODAS5P keeps this much better to a tolerance, since its estimate is that of a
/// worse method. One tolerance is to mean much the same by either.
const WEIGHT: f64 = 4.0;

/// Radau IIA for linear equations y' = J y + g(t) with a constant J: implicit, order 13, seven stages, L-stable.
///
/// A step needs no iteration. It solves one real and three complex systems of the equation's size, whose matrices are
/// factored once for each length of a step. The solution over a step is a polynomial of degree seven, and the error
/// control keeps its largest error inside the step within the tolerance. The end of a step is far more exact.
///
/// An oscillator y'' = -y from y = 1 comes round after 2 pi:
///
/// ```
/// use pump_model::integrator::{Ode, Options, Radau};
///
/// struct Oscillator;
///
/// impl Ode<2> for Oscillator {
///     fn derivative(&self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
///         [y[1], -y[0]]
///     }
///     fn jacobian(&self, _t: f64, _y: &[f64; 2]) -> [[f64; 2]; 2] {
///         [[0.0, 1.0], [-1.0, 0.0]]
///     }
///     fn time_derivative(&self, _t: f64, _y: &[f64; 2]) -> [f64; 2] {
///         [0.0; 2]
///     }
/// }
///
/// let mut solver = Radau::new(0.0, [1.0, 0.0], Options::uniform(1e-9)?)?;
/// while solver.time_s() < core::f64::consts::TAU {
///     solver.step(&Oscillator, core::f64::consts::TAU)?;
/// }
/// assert!((solver.state()[0] - 1.0).abs() < 1e-12 && solver.statistics().steps < 12);
/// # Ok::<(), pump_model::IntegrationError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Radau<const N: usize> {
    time_s: f64,
    state: SVector<f64, N>,
    options: Options<N>,
    /// Length that the error control asks for, s. A step clipped by a stop does not change it.
    proposed_s: f64,
    /// True if the next step starts where the equation changes.
    restart: bool,
    jacobian: [[f64; N]; N],
    factored: Option<Factored<N>>,
    statistics: Statistics,
}

impl<const N: usize> Radau<N> {
    /// Starts at `time_s` in `state`.
    ///
    /// # Errors
    ///
    /// Fails with [`IntegrationError::OutOfRange`] if a tolerance or the longest step is not allowed. By a
    /// tolerance that is NaN or negative, every step would be accepted.
    pub fn new(time_s: f64, state: [f64; N], options: Options<N>) -> Result<Self, IntegrationError> {
        options.validate()?;
        Ok(Self {
            time_s,
            state: state.into(),
            options,
            proposed_s: 0.0,
            restart: true,
            jacobian: [[0.0; N]; N],
            factored: None,
            statistics: Statistics::default(),
        })
    }

    /// Returns the time reached, s.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Returns the state at the time reached.
    pub fn state(&self) -> [f64; N] {
        self.state.into()
    }

    /// Announces that the equation changes or its derivative jumps here. The integrator asks for the Jacobian anew.
    pub fn restart(&mut self) {
        self.restart = true;
    }

    /// Replaces the state, as an impulse does.
    pub fn set_state(&mut self, state: [f64; N]) {
        self.state = state.into();
    }

    /// Returns the cost of the integration so far.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Makes one accepted step that ends at `stop_s` at the latest, and lands on it exactly. `ode` must be linear in
    /// its states with a constant Jacobian, and smooth up to there: the solution of another equation would be wrong.
    /// Before another equation is passed, [`Self::restart`] must be called.
    ///
    /// # Errors
    ///
    /// Fails if the state or its derivative is not finite, or if no step meets the tolerance.
    pub fn step(&mut self, ode: &impl Ode<N>, stop_s: f64) -> Result<DenseStep<N>, IntegrationError> {
        let start_s = self.time_s;
        let slope = SVector::from(ode.derivative(start_s, entries(&self.state)));
        self.statistics.evaluations += 1;
        if !(finite(&self.state) && finite(&slope)) {
            return Err(IntegrationError::NotFinite { time_s: start_s });
        }
        if self.restart {
            self.start(ode, &slope);
        }
        let (mut shortest_failed_s, mut defined) = (f64::INFINITY, true);
        loop {
            let wanted_s = self.proposed_s.min(self.options.max_step_s).min(LONGEST_STEP_S);
            let end_s = step_end(start_s, wanted_s, stop_s, self.options.max_step_s);
            let h = end_s - start_s;
            if h <= 0.0 || h >= shortest_failed_s {
                // No shorter step can be told from the one that failed.
                let error = IntegrationError::StepUnderflow { time_s: start_s };
                return Err(if defined { error } else { IntegrationError::NotFinite { time_s: start_s } });
            }
            let trial = self.trial(ode, &slope, end_s);
            let error = trial.as_ref().map_or(f64::INFINITY, |trial| self.error_norm(trial));
            let factor = (SAFETY / eighth_root(error.clamp(1e-10, 1e10))).clamp(SHRINK, GROW);
            match trial {
                Some(trial) if error <= 1.0 => {
                    // A step cut short by a stop does not count against the longer one proposed.
                    let grown_s = h * factor;
                    self.proposed_s = if h < wanted_s { grown_s.max(self.proposed_s) } else { grown_s };
                    self.statistics.steps += 1;
                    let [c1, c2, c3, c4, c5, c6, c7] = trial.coefficients;
                    let c = [self.state, c1, c2, c3, c4, c5, c6, c7];
                    self.time_s = end_s;
                    self.state = trial.next;
                    return Ok(DenseStep::new(start_s, h, trial.next, c));
                }
                failed => {
                    self.statistics.rejections += 1;
                    self.proposed_s = h * factor.min(SAFETY);
                    (shortest_failed_s, defined) = (h, failed.is_some());
                }
            }
        }
    }

    /// Learns the equation. The length of the very first step follows from the first two derivatives in units of the
    /// tolerance, by the rule of Hairer, Norsett, Wanner, "Solving ODEs I", section II.4. Later the length proposed
    /// stands: a jump of the slope shows in the error estimate of the step after it.
    fn start(&mut self, ode: &impl Ode<N>, slope: &SVector<f64, N>) {
        let jacobian = ode.jacobian(self.time_s, entries(&self.state));
        if jacobian != self.jacobian {
            self.factored = None;
        }
        self.jacobian = jacobian;
        self.restart = false;
        if self.proposed_s > 0.0 {
            return;
        }
        let slope_rate = ode.time_derivative(self.time_s, entries(&self.state));
        let mut largest = 0.0_f64;
        for (i, row) in jacobian.iter().enumerate() {
            let curvature = row.iter().zip(slope).map(|(j, slope)| j * slope).sum::<f64>() + slope_rate[i];
            let derivative = slope[i].abs().max(curvature.abs());
            largest = largest.max(derivative / self.options.allowed(&self.state, i));
        }
        self.proposed_s =
            if largest > 0.0 { 1.0 / eighth_root((100.0 * largest).clamp(1e-100, 1e100)) } else { 1.0 };
    }

    /// Returns the solution over a step to `end_s` with its error estimate; none if a matrix is singular or the
    /// result is not finite.
    fn trial(&mut self, ode: &impl Ode<N>, slope: &SVector<f64, N>, end_s: f64) -> Option<Trial<N>> {
        let h = end_s - self.time_s;
        // Lengths that are equal but for the rounding of times share their factors.
        let rounding_s = 2.0 * f64::EPSILON * self.time_s.abs().max(end_s.abs());
        if !self.factored.as_ref().is_some_and(|factored| (factored.length_s - h).abs() <= rounding_s) {
            self.statistics.factorisations += 1;
            self.factored = Factored::new(&self.jacobian, h);
        }
        let factored = self.factored.as_ref()?;
        let h = factored.length_s;
        self.statistics.evaluations += STAGES as u64;
        let slopes =
            NODES.map(|c| SVector::from(ode.derivative(self.time_s + c * h, entries(&self.state))) * h);
        let right = INTO.map(|row| weighted(&row, &slopes));
        let mut solved = [SVector::<f64, N>::zeros(); STAGES];
        solved[0] = factored.real.solve(right[0]);
        for (n, pair) in factored.pairs.iter().enumerate() {
            let (re, im) = (&right[1 + 2 * n], &right[2 + 2 * n]);
            let found = pair.solve(SVector::from_fn(|i, _| Complex { re: re[i], im: im[i] }));
            solved[1 + 2 * n] = found.map(|z| z.re);
            solved[2 + 2 * n] = found.map(|z| z.im);
        }
        let next = self.state + weighted(&END, &solved);
        let coefficients = OUT.map(|row| weighted(&row, &solved));
        // The slope of the polynomial at the start is wrong by what its degree leaves out. A system with the real
        // eigenvalue takes that of very stiff states away.
        let wrong = coefficients[0] - slope * h;
        let error = factored.real.solve(wrong) * (INSIDE * REAL * WEIGHT);
        (finite(&next) && finite(&error)).then_some(Trial { next, coefficients, error })
    }

    /// Returns the largest error of a state over the allowed error.
    fn error_norm(&self, trial: &Trial<N>) -> f64 {
        let mut largest = 0.0_f64;
        for i in 0..N {
            let allowed = self.options.allowed(&self.state, i).max(self.options.allowed(&trial.next, i));
            largest = largest.max(trial.error[i].abs() / allowed);
        }
        largest
    }
}

/// Factors of the matrices of a step: of lambda - h J for the real eigenvalue lambda and for one of each pair.
#[derive(Debug, Clone)]
struct Factored<const N: usize> {
    length_s: f64,
    real: Lu<f64, N>,
    pairs: [Lu<Complex, N>; PAIRS],
}

impl<const N: usize> Factored<N> {
    fn new(jacobian: &[[f64; N]; N], length_s: f64) -> Option<Self> {
        let entry =
            |i: usize, j: usize, lambda| if i == j { lambda } else { 0.0 } - length_s * jacobian[i][j];
        let complex = |[re, im]: [f64; 2]| {
            Lu::new(SMatrix::<Complex, N, N>::from_fn(|i, j| Complex {
                re: entry(i, j, re),
                im: if i == j { im } else { 0.0 },
            }))
        };
        let [first, second, third] = COMPLEX;
        Some(Self {
            length_s,
            real: Lu::new(SMatrix::<f64, N, N>::from_fn(|i, j| entry(i, j, REAL)))?,
            pairs: [complex(first)?, complex(second)?, complex(third)?],
        })
    }
}

/// Result of a step that was tried.
struct Trial<const N: usize> {
    next: SVector<f64, N>,
    /// Coefficients of x to x^7 of the solution over the step.
    coefficients: [SVector<f64, N>; STAGES],
    /// Estimate of the largest error inside the step.
    error: SVector<f64, N>,
}

/// Returns the end of a step of the `wanted` length. The time to the stop is cut into equal steps, so that they share
/// their factors.
fn step_end(start_s: f64, wanted_s: f64, stop_s: f64, longest_s: f64) -> f64 {
    let room_s = stop_s - start_s;
    if wanted_s > 0.999 * room_s && room_s <= longest_s {
        stop_s
    } else if room_s < f64::INFINITY {
        start_s + room_s / ceil(room_s / wanted_s).max(2.0)
    } else {
        start_s + wanted_s
    }
}

/// Returns the sum of the vectors with these weights.
#[inline]
fn weighted<const N: usize>(weights: &[f64; STAGES], vectors: &[SVector<f64, N>; STAGES]) -> SVector<f64, N> {
    let mut sum = vectors[0] * weights[0];
    for n in 1..STAGES {
        sum += vectors[n] * weights[n];
    }
    sum
}

/// Returns x^(1/8).
fn eighth_root(x: f64) -> f64 {
    sqrt(sqrt(sqrt(x)))
}
