//! A flow over time as people and programs give it: rows of time and flow.

mod error;
mod profile;
mod way_out;

pub use error::ProfileError;
pub use profile::FlowProfile;
pub use way_out::FlowWayOut;
