//! The steps of a motion as `queue_step` commands: runs of intervals in whole ticks of a board's clock.
//!
//! A plan gives the time of each step in seconds. A board takes an interval, a count and an addition, all whole numbers
//! (Klipper, docs/MCU_Commands.md, "queue_step"). [`Refit`] finds the longest run of steps that such numbers put near
//! their times, and begins each run where the last one really ended, so that errors do not add up.

mod command;
mod corridor;
mod error;
mod refit;
mod step_timer;
#[cfg(test)]
mod tests;

pub(super) use command::StepCommand;
pub use error::RefitError;
pub(super) use refit::{Refit, StepRun};
pub(super) use step_timer::StepTimer;
