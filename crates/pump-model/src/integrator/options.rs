//! How exactly to integrate, and what it cost.

use nalgebra::SVector;

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
    /// Options with one tolerance for every state, relative and absolute.
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
    /// Accepted steps.
    pub steps: u64,
    /// Steps tried again with a shorter length.
    pub rejections: u64,
    /// Matrices factored: one a step that was tried.
    pub factorisations: u64,
    /// Evaluations of f.
    pub evaluations: u64,
}
