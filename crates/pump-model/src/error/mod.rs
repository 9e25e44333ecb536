//! Errors of the model, and the check that refuses a value outside its range.

mod allowed;
mod integration;
mod model;
mod parameter;
mod shown;
mod within;

pub use allowed::Allowed;
pub use integration::IntegrationError;
pub use model::ModelError;
pub use parameter::Parameter;
pub use shown::Shown;
pub(crate) use within::{refused, within};
