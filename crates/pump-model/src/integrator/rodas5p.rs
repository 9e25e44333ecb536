//! Steps of RODAS5P: error control, stops, statistics.

use nalgebra::{SMatrix, SVector};

use crate::error::IntegrationError;
use crate::math::hermite::End;

use super::dense::DenseStep;
use super::lu::Lu;
use super::ode::Ode;
use super::options::{Options, Statistics};
use super::tableau::{A, ALPHA, C, GAMMA, GAMMA_I, H, STAGES};

/// Safety factor of the step length. The error estimate is of order h^5, so a step is scaled by the fifth
/// root of the error.
const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;
const GROW: f64 = 6.0;
/// Longest step, s. A state at rest lets the steps grow without end, and beyond this nothing is gained.
pub(super) const LONGEST_STEP_S: f64 = 1e100;
/// Ratio of a step to the fastest time constant above which the step is stiff. Beyond it the Hermite
/// polynomial would magnify the error of the step's ends more than a hundredfold.
const STIFF: f64 = 10.0;

/// RODAS5P: linearly implicit, order 5(4), eight stages, one factorisation a step, L-stable.
#[derive(Debug, Clone)]
pub struct Rodas5p<const N: usize> {
    time_s: f64,
    state: SVector<f64, N>,
    options: Options<N>,
    /// Length that the error control asks for, s. A step clipped by a stop does not change it.
    proposed_s: f64,
    /// True if the next step starts where the derivative jumps.
    restart: bool,
    /// Values that the last step evaluated at its end, for the next to start from.
    known: Option<StepStart<N>>,
    statistics: Statistics,
}

impl<const N: usize> Rodas5p<N> {
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
            known: None,
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

    /// Announces that the equation changes or its derivative jumps here. The integrator forgets all that it
    /// knows of the equation, and makes the next step short enough for the new one.
    pub fn restart(&mut self) {
        self.restart = true;
    }

    /// Replaces the state, as an impulse does.
    pub fn set_state(&mut self, state: [f64; N]) {
        self.state = state.into();
        self.known = None;
    }

    /// Returns the cost of the integration so far.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Makes one accepted step that ends at `stop_s` at the latest, and lands on it exactly. `ode` must be
    /// smooth up to there. Before another equation is passed, [`Self::restart`] must be called.
    ///
    /// # Errors
    ///
    /// Fails if the state or its derivative is not finite, or if no step meets the tolerance.
    pub fn step(&mut self, ode: &impl Ode<N>, stop_s: f64) -> Result<DenseStep<N>, IntegrationError> {
        let from = match self.known.take() {
            Some(known) if !self.restart => known,
            _ => {
                self.statistics.evaluations += 1;
                StepStart::new(ode, self.time_s, self.state)?
            }
        };
        if self.restart {
            let first_s = self.first_step(&from);
            self.proposed_s = if self.proposed_s > 0.0 { self.proposed_s.min(first_s) } else { first_s };
            self.restart = false;
        }
        let (mut shortest_failed_s, mut defined) = (f64::INFINITY, true);
        loop {
            let wanted = self.proposed_s.min(self.options.max_step_s).min(LONGEST_STEP_S);
            let end_s = step_end(from.time_s, wanted, stop_s, self.options.max_step_s);
            let h = end_s - from.time_s;
            if h <= 0.0 || h >= shortest_failed_s {
                // No shorter step can be told from the one that failed.
                let time_s = from.time_s;
                let error = IntegrationError::StepUnderflow { time_s };
                return Err(if defined { error } else { IntegrationError::NotFinite { time_s } });
            }
            let trial = self.trial(ode, &from, h);
            let error = trial.as_ref().map_or(f64::INFINITY, |trial| self.error_norm(&from.state, trial));
            let factor = (SAFETY * reciprocal_fifth_root(error.clamp(1e-10, 1e10))).clamp(SHRINK, GROW);
            match trial {
                Some(trial) if error <= 1.0 => {
                    // A step cut short by a stop or by halving does not count against the longer one
                    // proposed.
                    let grown = h * factor;
                    self.proposed_s = if h < wanted { grown.max(self.proposed_s) } else { grown };
                    self.statistics.steps += 1;
                    self.time_s = end_s;
                    self.state = trial.next;
                    return self.dense(ode, &from, h, &trial);
                }
                failed => {
                    self.statistics.rejections += 1;
                    self.proposed_s = h * factor.min(SAFETY);
                    (shortest_failed_s, defined) = (h, failed.is_some());
                }
            }
        }
    }

    /// Returns the new state and the error estimate of a step of length `h`; none if the matrix is singular
    /// or the result is not finite.
    fn trial(&mut self, ode: &impl Ode<N>, from: &StepStart<N>, h: f64) -> Option<Trial<N>> {
        self.statistics.factorisations += 1;
        self.statistics.evaluations += STAGES as u64 - 1;
        let per_h = 1.0 / h;
        let diagonal = |i, j| if i == j { per_h / GAMMA } else { 0.0 };
        let lu = Lu::new(SMatrix::<f64, N, N>::from_fn(|i, j| diagonal(i, j) - from.jacobian[i][j]))?;
        // Solves stage i (from 0), at a value of the state and with the coupling to the stages before.
        let solve = |i: usize, value: &SVector<f64, N>, coupled: SVector<f64, N>| {
            let slope = SVector::from(ode.derivative(from.time_s + ALPHA[i] * h, entries(value)));
            lu.solve(slope + coupled * per_h + from.slope_rate * (h * GAMMA_I[i]))
        };
        let mut u = [SVector::<f64, N>::zeros(); STAGES];
        u[0] = lu.solve(from.slope + from.slope_rate * (h * GAMMA_I[0]));
        u[1] = solve(1, &(from.state + sum::<1, 5, N>(&A[0], &u)), sum::<1, 7, N>(&C[0], &u));
        u[2] = solve(2, &(from.state + sum::<2, 5, N>(&A[1], &u)), sum::<2, 7, N>(&C[1], &u));
        u[3] = solve(3, &(from.state + sum::<3, 5, N>(&A[2], &u)), sum::<3, 7, N>(&C[2], &u));
        u[4] = solve(4, &(from.state + sum::<4, 5, N>(&A[3], &u)), sum::<4, 7, N>(&C[3], &u));
        let mut value = from.state + sum::<5, 5, N>(&A[4], &u);
        u[5] = solve(5, &value, sum::<5, 7, N>(&C[4], &u));
        value += u[5];
        u[6] = solve(6, &value, sum::<6, 7, N>(&C[5], &u));
        value += u[6];
        u[7] = solve(7, &value, sum::<7, 7, N>(&C[6], &u));
        let next = value + u[7];
        (finite(&next) && finite(&u[7])).then_some(Trial { next, stages: u })
    }

    /// Returns the dense output of an accepted step: by Hermite interpolation where the problem is not stiff
    /// over this step, by the method's own output where it is.
    fn dense(
        &mut self,
        ode: &impl Ode<N>,
        from: &StepStart<N>,
        h: f64,
        trial: &Trial<N>,
    ) -> Result<DenseStep<N>, IntegrationError> {
        if h * self.rate(&from.jacobian, &from.state) > STIFF {
            let k = H.map(|weights| {
                let weighted = weights.iter().zip(&trial.stages).map(|(weight, stage)| stage * *weight);
                weighted.fold(SVector::zeros(), |sum, term| sum + term)
            });
            return Ok(DenseStep::own(from.time_s, h, from.state, trial.next, k));
        }
        let to = StepStart::new(ode, self.time_s, trial.next)?;
        self.statistics.evaluations += 1;
        let step = DenseStep::hermite(from.time_s, h, &from.end(), &to.end());
        self.known = Some(to);
        Ok(step)
    }

    /// Returns the largest rate at which the states change one another, 1/s: the row norm of the Jacobian in
    /// units of the tolerance.
    fn rate(&self, jacobian: &[[f64; N]; N], state: &SVector<f64, N>) -> f64 {
        let mut largest = 0.0_f64;
        for (i, row) in jacobian.iter().enumerate() {
            let change: f64 = (0..N).map(|j| row[j].abs() * self.options.allowed(state, j)).sum();
            largest = largest.max(change / self.options.allowed(state, i));
        }
        largest
    }

    /// Returns the largest error of a state over the allowed error.
    fn error_norm(&self, from: &SVector<f64, N>, trial: &Trial<N>) -> f64 {
        let mut largest = 0.0_f64;
        for i in 0..N {
            let allowed = self.options.allowed(from, i).max(self.options.allowed(&trial.next, i));
            largest = largest.max(trial.stages[STAGES - 1][i].abs() / allowed);
        }
        largest
    }

    /// Returns the length of the first step, from the first two derivatives in units of the tolerance. The
    /// rule is that of Hairer, Norsett, Wanner, "Solving ODEs I", section II.4, with the exact second
    /// derivative in place of an Euler step.
    fn first_step(&self, from: &StepStart<N>) -> f64 {
        let mut largest = 0.0_f64;
        for i in 0..N {
            let derivative = from.slope[i].abs().max(from.curvature()[i].abs());
            largest = largest.max(derivative / self.options.allowed(&from.state, i));
        }
        if largest > 0.0 { reciprocal_fifth_root((100.0 * largest).clamp(1e-100, 1e100)) } else { 1.0 }
    }
}

/// State and derivatives where a step starts or ends.
#[derive(Debug, Clone)]
struct StepStart<const N: usize> {
    time_s: f64,
    state: SVector<f64, N>,
    slope: SVector<f64, N>,
    slope_rate: SVector<f64, N>,
    jacobian: [[f64; N]; N],
}

impl<const N: usize> StepStart<N> {
    fn new(ode: &impl Ode<N>, time_s: f64, state: SVector<f64, N>) -> Result<Self, IntegrationError> {
        let slope = SVector::from(ode.derivative(time_s, entries(&state)));
        if !(finite(&state) && finite(&slope)) {
            return Err(IntegrationError::NotFinite { time_s });
        }
        let jacobian = ode.jacobian(time_s, entries(&state));
        let slope_rate = SVector::from(ode.time_derivative(time_s, entries(&state)));
        Ok(Self { time_s, state, slope, slope_rate, jacobian })
    }

    /// Returns the curvature y'' = J f + f_t.
    fn curvature(&self) -> SVector<f64, N> {
        let product = self.jacobian.map(|row| row.iter().zip(&self.slope).map(|(j, slope)| j * slope).sum());
        SVector::from(product) + self.slope_rate
    }

    fn end(&self) -> End<SVector<f64, N>> {
        End { value: self.state, slope: self.slope, curvature: self.curvature() }
    }
}

/// Result of a step that was tried.
struct Trial<const N: usize> {
    next: SVector<f64, N>,
    /// Stages of the step; the last is the error estimate.
    stages: [SVector<f64, N>; STAGES],
}

/// Returns the end of a step of the `wanted` length. It is the stop if that lies within reach, and half way
/// to it if the step would leave less than a step's length.
fn step_end(start_s: f64, wanted_s: f64, stop_s: f64, longest_s: f64) -> f64 {
    let room_s = stop_s - start_s;
    if wanted_s > 0.999 * room_s && room_s <= longest_s {
        stop_s
    } else if wanted_s > 0.5 * room_s {
        start_s + 0.5 * room_s
    } else {
        start_s + wanted_s
    }
}

/// Returns the sum of the first K stages with these weights. K is known at compile time, so the loop unrolls.
fn sum<const K: usize, const W: usize, const N: usize>(
    weights: &[f64; W],
    stages: &[SVector<f64, N>; STAGES],
) -> SVector<f64, N> {
    let mut sum = stages[0] * weights[0];
    for k in 1..K {
        sum += stages[k] * weights[k];
    }
    sum
}

/// Returns x^(-1/5) to 1e-6, for the step size control. `x` must be positive and normal.
///
/// The first guess comes from the exponent's bits, then Newton's method solves y^(-5) = x. This is four times
/// faster than the general power, and gives the same bits on every target.
fn reciprocal_fifth_root(x: f64) -> f64 {
    // The guess takes 1/5 of the exponent with its sign changed, and 6/5 of the bias.
    let mut y = f64::from_bits(0x4CB9_9999_9999_9999 - x.to_bits() / 5);
    for _ in 0..4 {
        let y2 = y * y;
        y *= 1.2 - 0.2 * x * y2 * y2 * y;
    }
    y
}

/// Returns the entries of a vector.
pub(super) fn entries<const N: usize>(vector: &SVector<f64, N>) -> &[f64; N] {
    let [column] = &vector.data.0;
    column
}

pub(super) fn finite<const N: usize>(vector: &SVector<f64, N>) -> bool {
    vector.iter().all(|x| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::reciprocal_fifth_root;

    #[test]
    fn the_fifth_root_is_good_enough_for_step_sizes() {
        for n in -100..=100 {
            for x in [1.0, 1.7, 3.0, 7.9] {
                let x = x * libm::pow(10.0, f64::from(n));
                assert!((reciprocal_fifth_root(x) * libm::pow(x, 0.2) - 1.0).abs() < 1e-6, "{x}");
            }
        }
    }
}
