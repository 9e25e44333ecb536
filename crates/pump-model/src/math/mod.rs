//! Polynomials and the metrics of a fit.

pub(crate) mod hermite;
pub mod metrics;
pub mod polynomial;
