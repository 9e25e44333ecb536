//! Errors for programs: the facts of every error, and their JSON.

mod explain;
mod kind;
mod of_bench;
mod of_files;
mod of_model;
mod report;

pub use explain::{ErrorFacts, Explain};
pub use kind::ErrorKind;
pub use report::ErrorReport;
