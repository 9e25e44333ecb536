//! Errors of the model, and the check that refuses a value outside its range.

mod allowed;
mod integration;
mod model;
mod within;

pub use allowed::Allowed;
pub use integration::IntegrationError;
pub use model::ModelError;
pub(crate) use within::{refused, within};
