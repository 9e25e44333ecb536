//! Errors of the integrator.

use thiserror::Error;

use super::allowed::Allowed;
use super::parameter::Parameter;
use super::shown::Shown;

/// Reason why an integration stopped before its end.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum IntegrationError {
    /// The state or its derivative is not a finite number.
    #[error("the state is not finite at t = {} s", Shown(*time_s))]
    NotFinite {
        /// Time at which the state is not finite, s.
        time_s: f64,
    },
    /// No step meets the tolerance.
    #[error("the step size underflows at t = {} s; loosen the tolerance", Shown(*time_s))]
    StepUnderflow {
        /// Time at which no step meets the tolerance, s.
        time_s: f64,
    },
    /// The tolerance lies outside the range that double precision can meet.
    #[error("integration tolerance {tolerance:e}; allowed: 1e-13 to 0.1")]
    Tolerance {
        /// Tolerance that was asked for.
        tolerance: f64,
    },
    /// The model of the line is not linear, and Radau's method integrates linear ones.
    #[error("the model of the line is not linear, as Radau's method needs it; allowed: RODAS5P")]
    NotLinear,
    /// An option of the integrator lies outside its range.
    #[error("{parameter} is {value:e}; allowed: {allowed}")]
    OutOfRange {
        /// Option of the integrator.
        parameter: Parameter,
        /// Value that was given.
        value: f64,
        /// Values that are accepted.
        allowed: Allowed,
    },
}
