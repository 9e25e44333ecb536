//! Motions by the board: leave and segments out, steps made in.

mod asked;
mod convoy;
mod motion;
mod move_feed;
mod outcome;
mod search;
mod steps;
mod task;
mod walk;

pub(super) use asked::LastAsked;
pub(super) use convoy::{AHEAD, run};
pub(super) use motion::Motion;
pub(super) use outcome::{Fault, Made};
pub(super) use task::{Room, Task, most_steps_s};
