//! The schedule in force: its runs are given as orders when they are due.

mod doubt;
mod edit;
mod editing;
mod loaded;
mod refusal;
mod run;
mod runner;
mod trial;

pub use self::editing::Edit;
pub use self::refusal::EditError;
pub use self::runner::{Runner, RunnerError};
