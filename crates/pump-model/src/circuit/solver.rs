//! The integrator of a line's run: one of two.

use crate::error::IntegrationError;
use crate::integrator::{DenseStep, Ode, Radau, Rodas5p, Statistics};

/// Integrator of a run.
#[derive(Debug, Clone)]
pub(super) enum Solver<const N: usize> {
    /// For any equation.
    Rodas5p(Rodas5p<N>),
    /// For linear equations.
    Radau(Radau<N>),
}

impl<const N: usize> Solver<N> {
    pub(super) fn time_s(&self) -> f64 {
        match self {
            Self::Rodas5p(solver) => solver.time_s(),
            Self::Radau(solver) => solver.time_s(),
        }
    }

    pub(super) fn state(&self) -> [f64; N] {
        match self {
            Self::Rodas5p(solver) => solver.state(),
            Self::Radau(solver) => solver.state(),
        }
    }

    pub(super) fn restart(&mut self) {
        match self {
            Self::Rodas5p(solver) => solver.restart(),
            Self::Radau(solver) => solver.restart(),
        }
    }

    #[inline]
    pub(super) fn step(&mut self, ode: &impl Ode<N>, stop_s: f64) -> Result<DenseStep<N>, IntegrationError> {
        match self {
            Self::Rodas5p(solver) => solver.step(ode, stop_s),
            Self::Radau(solver) => solver.step(ode, stop_s),
        }
    }

    pub(super) fn statistics(&self) -> Statistics {
        match self {
            Self::Rodas5p(solver) => solver.statistics(),
            Self::Radau(solver) => solver.statistics(),
        }
    }
}
