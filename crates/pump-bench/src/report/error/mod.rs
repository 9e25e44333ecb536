//! Errors for programs: the facts of every error, and their JSON.

mod explain;
mod kind;
mod of_balance;
mod of_bench;
mod of_drives;
mod of_files;
mod of_model;
mod of_sizing;
mod remedies;
mod remedies_of_drives;
mod report;

pub use explain::{ErrorFacts, Explain};
pub use kind::ErrorKind;
pub use report::ErrorReport;
