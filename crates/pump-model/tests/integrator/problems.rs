//! Differential equations with known solutions, and helpers that integrate them.

use nalgebra::{SMatrix, SVector};
use pump_model::integrator::{IntegrationError, Ode, Options, Rodas5p};

/// Equation y' = f(t, y) from its three functions.
pub(crate) struct Problem<F, J, T> {
    pub derivative: F,
    pub jacobian: J,
    pub time_derivative: T,
}

impl<const N: usize, F, J, T> Ode<N> for Problem<F, J, T>
where
    F: Fn(f64, &SVector<f64, N>) -> SVector<f64, N>,
    J: Fn(f64, &SVector<f64, N>) -> SMatrix<f64, N, N>,
    T: Fn(f64, &SVector<f64, N>) -> SVector<f64, N>,
{
    fn derivative(&self, t: f64, y: &[f64; N]) -> [f64; N] {
        (self.derivative)(t, &SVector::from(*y)).into()
    }
    fn jacobian(&self, t: f64, y: &[f64; N]) -> [[f64; N]; N] {
        let jacobian = (self.jacobian)(t, &SVector::from(*y));
        core::array::from_fn(|i| core::array::from_fn(|j| jacobian[(i, j)]))
    }
    fn time_derivative(&self, t: f64, y: &[f64; N]) -> [f64; N] {
        (self.time_derivative)(t, &SVector::from(*y)).into()
    }
}

/// Returns the equation of f(y) without time.
pub(crate) fn autonomous<const N: usize>(
    derivative: impl Fn(&SVector<f64, N>) -> SVector<f64, N>,
    jacobian: impl Fn(&SVector<f64, N>) -> SMatrix<f64, N, N>,
) -> impl Ode<N> {
    Problem {
        derivative: move |_t: f64, y: &SVector<f64, N>| derivative(y),
        jacobian: move |_t: f64, y: &SVector<f64, N>| jacobian(y),
        time_derivative: |_t: f64, _y: &SVector<f64, N>| SVector::zeros(),
    }
}

/// Equation of one state: f, df/dy and df/dt.
pub(crate) fn scalar(
    derivative: impl Fn(f64, f64) -> f64,
    jacobian: impl Fn(f64, f64) -> f64,
    time_derivative: impl Fn(f64, f64) -> f64,
) -> impl Ode<1> {
    Problem {
        derivative: move |t: f64, y: &SVector<f64, 1>| SVector::<f64, 1>::new(derivative(t, y[0])),
        jacobian: move |t: f64, y: &SVector<f64, 1>| SMatrix::<f64, 1, 1>::new(jacobian(t, y[0])),
        time_derivative: move |t: f64, y: &SVector<f64, 1>| SVector::<f64, 1>::new(time_derivative(t, y[0])),
    }
}

pub(crate) const ECCENTRICITY: f64 = 0.3;

/// Motion of two bodies: position and velocity, started at the pericentre (Hairer, Norsett, Wanner, "Solving
/// ODEs I", II.10).
pub(crate) fn kepler() -> impl Ode<4> {
    autonomous(
        |y: &SVector<f64, 4>| {
            let cubed = (y[0] * y[0] + y[1] * y[1]).powf(1.5);
            SVector::<f64, 4>::new(y[2], y[3], -y[0] / cubed, -y[1] / cubed)
        },
        |y: &SVector<f64, 4>| {
            let squared = y[0] * y[0] + y[1] * y[1];
            let (third, fifth) = (squared.powf(-1.5), 3.0 * squared.powf(-2.5));
            let mut j = SMatrix::<f64, 4, 4>::zeros();
            (j[(0, 2)], j[(1, 3)]) = (1.0, 1.0);
            j[(2, 0)] = fifth * y[0] * y[0] - third;
            j[(3, 1)] = fifth * y[1] * y[1] - third;
            (j[(2, 1)], j[(3, 0)]) = (fifth * y[0] * y[1], fifth * y[0] * y[1]);
            j
        },
    )
}

/// Returns the solution for two bodies, by Newton's method for Kepler's equation.
pub(crate) fn kepler_solution(t: f64) -> SVector<f64, 4> {
    let e = ECCENTRICITY;
    let mut anomaly = t;
    for _ in 0..20 {
        anomaly -= (anomaly - e * anomaly.sin() - t) / (1.0 - e * anomaly.cos());
    }
    let minor = (1.0 - e * e).sqrt();
    let rate = 1.0 / (1.0 - e * anomaly.cos());
    SVector::<f64, 4>::new(
        anomaly.cos() - e,
        minor * anomaly.sin(),
        -anomaly.sin() * rate,
        minor * anomaly.cos() * rate,
    )
}

/// Returns options whose tolerance accepts every step, so that `max_step_s` alone decides. Lengths and ends
/// that are powers of two make the steps equal to the last bit.
pub(crate) fn fixed<const N: usize>(step_s: f64) -> Options<N> {
    Options::uniform(1e30).unwrap().with_max_step_s(step_s)
}

/// Returns a solver with one tolerance for every state.
pub(crate) fn uniform<const N: usize>(time_s: f64, state: SVector<f64, N>, tolerance: f64) -> Rodas5p<N> {
    Rodas5p::new(time_s, state.into(), Options::uniform(tolerance).unwrap()).unwrap()
}

/// Goes to `end_s` in at most `most_steps` steps, and panics beyond, so no test runs for ever.
pub(crate) fn go<const N: usize>(
    solver: &mut Rodas5p<N>,
    ode: &impl Ode<N>,
    end_s: f64,
    most_steps: u64,
) -> Result<SVector<f64, N>, IntegrationError> {
    while solver.time_s() < end_s {
        solver.step(ode, end_s)?;
        assert!(solver.statistics().steps <= most_steps, "{:?} at {}", solver.statistics(), solver.time_s());
    }
    Ok(SVector::from(solver.state()))
}

/// Returns the orders observed between errors of steps that halve.
pub(crate) fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

/// Returns the largest entry without its sign.
///
/// nalgebra's `amax` within a maximum over an unrolled loop lost the last of seven values at optimisation level 2
/// (rustc 1.95), so that an error of 3.0e-4 read as 2.3e-4.
pub(crate) fn largest<const N: usize>(v: &SVector<f64, N>) -> f64 {
    v.iter().fold(0.0, |most, entry| most.max(entry.abs()))
}
