//! The integrator of the chambers, in a size that has room for all segments.

use crate::error::IntegrationError;
use crate::integrator::{COEFFICIENTS, DenseStep, Rodas5p, Statistics};
use crate::line::line::Line;
use crate::math::polynomial::Polynomial;

use super::chambers::{Chambers, Equations, SEGMENTS, STATES, StateVector, options};

/// Number of states with two segments at most, as a pump with three rollers has them.
const FEW: usize = SEGMENTS + 2;

/// The integrator. A factorisation costs the cube of its size, so absent segments are left out where they are many.
#[derive(Debug, Clone)]
#[expect(clippy::large_enum_variant, reason = "there is no allocator, and a run holds one integrator")]
pub(super) enum Solver {
    Few(Rodas5p<FEW>),
    Many(Rodas5p<STATES>),
}

/// Accepted step with its dense output.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::large_enum_variant, reason = "there is no allocator, and a run holds one step")]
pub(super) enum Step {
    Few(DenseStep<FEW>),
    Many(DenseStep<STATES>),
}

impl Solver {
    /// Starts at `start_s` in `state`, with `segments` at most.
    pub(super) fn new(
        segments: usize,
        start_s: f64,
        state: &StateVector,
        [inlet, outlet]: [&Line; 2],
        tolerance: f64,
    ) -> Result<Self, IntegrationError> {
        Ok(if SEGMENTS + segments <= FEW {
            Self::Few(Rodas5p::new(start_s, resized(state), options(inlet, outlet, tolerance))?)
        } else {
            Self::Many(Rodas5p::new(start_s, *state, options(inlet, outlet, tolerance))?)
        })
    }

    /// Returns the time reached, s.
    pub(super) fn time_s(&self) -> f64 {
        match self {
            Self::Few(solver) => solver.time_s(),
            Self::Many(solver) => solver.time_s(),
        }
    }

    /// Returns the state reached.
    pub(super) fn state(&self) -> StateVector {
        match self {
            Self::Few(solver) => resized(&solver.state()),
            Self::Many(solver) => solver.state(),
        }
    }

    /// Goes on in another state, by another equation.
    pub(super) fn restart(&mut self, state: &StateVector) {
        match self {
            Self::Few(solver) => {
                solver.set_state(resized(state));
                solver.restart();
            }
            Self::Many(solver) => {
                solver.set_state(*state);
                solver.restart();
            }
        }
    }

    /// Returns the cost of the integration so far.
    pub(super) fn statistics(&self) -> Statistics {
        match self {
            Self::Few(solver) => solver.statistics(),
            Self::Many(solver) => solver.statistics(),
        }
    }

    /// Makes one accepted step that ends at `stop_s` at the latest.
    pub(super) fn step(&mut self, chambers: &Chambers<'_>, stop_s: f64) -> Result<Step, IntegrationError> {
        Ok(match self {
            Self::Few(solver) => Step::Few(solver.step(&Equations::new(chambers), stop_s)?),
            Self::Many(solver) => Step::Many(solver.step(&Equations::new(chambers), stop_s)?),
        })
    }
}

impl Step {
    /// Returns the start of the step, s.
    pub(super) fn start_s(&self) -> f64 {
        match self {
            Self::Few(step) => step.start_s,
            Self::Many(step) => step.start_s,
        }
    }

    /// Returns the length of the step, s.
    pub(super) fn length_s(&self) -> f64 {
        match self {
            Self::Few(step) => step.length_s,
            Self::Many(step) => step.length_s,
        }
    }

    /// Returns the state at time `t_s` inside the step.
    pub(super) fn at(&self, t_s: f64) -> StateVector {
        match self {
            Self::Few(step) => resized(&step.at(t_s)),
            Self::Many(step) => step.at(t_s),
        }
    }

    /// Returns a state of the lines as a polynomial in the part of the step that has passed.
    pub(super) fn polynomial(&self, state: usize) -> Polynomial<COEFFICIENTS> {
        match self {
            Self::Few(step) => step.polynomial(state),
            Self::Many(step) => step.polynomial(state),
        }
    }
}

/// Returns a state with more absent segments, or with fewer.
fn resized<const FROM: usize, const TO: usize>(state: &[f64; FROM]) -> [f64; TO] {
    let mut resized = [0.0; TO];
    for (to, from) in resized.iter_mut().zip(state) {
        *to = *from;
    }
    resized
}
