//! Options and cost of an integration.

use nalgebra::SVector;

use crate::error::{Allowed, IntegrationError, Parameter};

/// Tolerances and longest step of an integration. [`super::Rodas5p::new`] and
/// [`super::Radau::new`] check them.
///
/// ```
/// use pump_model::integrator::Options;
///
/// let options = Options::new([1e-6, 0.0], [1e-6, 1e-3]).with_max_step_s(0.1);
/// assert_eq!((options.absolute[1], options.max_step_s), (1e-3, 0.1));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Options<const N: usize> {
    /// Error allowed in a step, relative to each state; zero or more.
    pub relative: [f64; N],
    /// Error allowed in a step, in the units of each state; positive.
    pub absolute: [f64; N],
    /// Longest step, s; positive, and infinite by default.
    pub max_step_s: f64,
}

impl<const N: usize> Options<N> {
    /// Returns options with the errors allowed in a step, relative to each state and in its units. The steps may
    /// be of any length.
    pub const fn new(relative: [f64; N], absolute: [f64; N]) -> Self {
        Self { relative, absolute, max_step_s: f64::INFINITY }
    }

    /// Replaces the errors allowed relative to each state.
    #[must_use]
    pub const fn with_relative(self, relative: [f64; N]) -> Self {
        Self { relative, ..self }
    }

    /// Replaces the errors allowed in the units of each state.
    #[must_use]
    pub const fn with_absolute(self, absolute: [f64; N]) -> Self {
        Self { absolute, ..self }
    }

    /// Replaces the longest step, s.
    #[must_use]
    pub const fn with_max_step_s(self, max_step_s: f64) -> Self {
        Self { max_step_s, ..self }
    }

    /// Returns options with one tolerance for every state, relative and absolute.
    ///
    /// ```
    /// use pump_model::integrator::Options;
    ///
    /// assert_eq!(Options::<2>::uniform(1e-6)?.relative, [1e-6; 2]);
    /// let refused = Options::<2>::uniform(-1.0).unwrap_err();
    /// assert_eq!(refused.to_string(), "tolerance of a step is -1e0; allowed: a positive number");
    /// # Ok::<(), pump_model::IntegrationError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Fails with [`IntegrationError::OutOfRange`] if the tolerance is not finite and positive.
    pub fn uniform(tolerance: f64) -> Result<Self, IntegrationError> {
        within(Parameter::Tolerance, tolerance, Allowed::POSITIVE)?;
        Ok(Self::equal(tolerance))
    }

    /// Returns options with one tolerance for every state. The tolerance is not checked.
    pub(crate) const fn equal(tolerance: f64) -> Self {
        Self::new([tolerance; N], [tolerance; N])
    }

    /// Returns the error allowed of a state in a step.
    pub(super) fn allowed(&self, state: &SVector<f64, N>, i: usize) -> f64 {
        self.absolute[i] + self.relative[i] * state[i].abs()
    }

    /// Refuses options by which an error estimate would mean nothing.
    pub(super) fn validate(&self) -> Result<(), IntegrationError> {
        for relative in self.relative {
            within(Parameter::RelativeTolerance, relative, Allowed::NotNegative)?;
        }
        for absolute in self.absolute {
            within(Parameter::AbsoluteTolerance, absolute, Allowed::POSITIVE)?;
        }
        if self.max_step_s > 0.0 {
            return Ok(());
        }
        let allowed = Allowed::Words("a positive length, or infinity");
        Err(IntegrationError::OutOfRange {
            parameter: Parameter::LongestStep,
            value: self.max_step_s,
            allowed,
        })
    }
}

fn within(parameter: Parameter, value: f64, allowed: Allowed) -> Result<(), IntegrationError> {
    let refused = IntegrationError::OutOfRange { parameter, value, allowed };
    if allowed.admits(value) { Ok(()) } else { Err(refused) }
}

/// Cost of an integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Statistics {
    /// Number of accepted steps.
    pub steps: u64,
    /// Number of steps tried again with a shorter length.
    pub rejections: u64,
    /// Number of factorisations: by RODAS5P of one matrix for each step that was tried, by Radau's method of four
    /// small ones for each new length of a step.
    pub factorisations: u64,
    /// Number of evaluations of f.
    pub evaluations: u64,
}
