//! The implicit integrator: adaptive RODAS5P of fixed size, without allocation.

mod dense;
mod lu;
mod ode;
mod options;
mod rodas5p;
mod tableau;

pub use crate::error::IntegrationError;
pub use dense::DenseStep;
pub use ode::Ode;
pub use options::{Options, Statistics};
pub use rodas5p::Rodas5p;
