//! Options and cost of an integration.

use nalgebra::SVector;

/// Tolerances and longest step of an integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options<const N: usize> {
    /// Error allowed in a step, relative to each state; zero or more.
    pub relative: SVector<f64, N>,
    /// Error allowed in a step, in the units of each state; positive.
    pub absolute: SVector<f64, N>,
    /// Longest step, s; infinite by default.
    pub max_step_s: f64,
}

impl<const N: usize> Options<N> {
    /// Returns options with one tolerance for every state, relative and absolute.
    pub fn uniform(tolerance: f64) -> Self {
        Self {
            relative: SVector::repeat(tolerance),
            absolute: SVector::repeat(tolerance),
            max_step_s: f64::INFINITY,
        }
    }
}

/// Cost of an integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statistics {
    /// Number of accepted steps.
    pub steps: u64,
    /// Number of steps tried again with a shorter length.
    pub rejections: u64,
    /// Number of matrices factored: one for each step that was tried.
    pub factorisations: u64,
    /// Number of evaluations of f.
    pub evaluations: u64,
}
