//! Errors for programs: the facts of every error, and their JSON.

mod explain;
mod kind;
mod of_balance;
mod of_bench;
mod of_files;
mod of_model;
mod remedies;
mod remedy;
mod report;

pub use explain::{ErrorFacts, Explain};
pub use kind::ErrorKind;
pub use remedy::Remedy;
pub use report::ErrorReport;
