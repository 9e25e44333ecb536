//! A flow over time as people and programs give it: rows of time and flow.

mod error;
mod profile;

pub use error::ProfileError;
pub use profile::FlowProfile;
