//! The schedule in force: its runs are given as orders when they are due.

mod doubt;
mod loaded;
mod run;
mod runner;

pub use self::runner::{Runner, RunnerError};
