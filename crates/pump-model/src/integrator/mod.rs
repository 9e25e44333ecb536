//! The implicit integrators: RODAS5P for any equation and Radau's method for linear ones, with steps of their own
//! choice, of fixed size, without allocation.

mod complex;
mod dense;
mod lu;
mod ode;
mod options;
mod radau;
mod radau_tableau;
mod rodas5p;
mod tableau;

pub use crate::error::IntegrationError;
pub use dense::{COEFFICIENTS, DenseStep};
pub use ode::Ode;
pub use options::{Options, Statistics};
pub use radau::Radau;
pub use rodas5p::Rodas5p;
