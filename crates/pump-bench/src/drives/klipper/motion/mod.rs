//! Motions by the board: leave and commands of steps out, steps made by the board's clock.
//!
//! Steps that a board has in its queue cannot be taken back, and end where the queue ends. So the queue is short, and
//! the way to rest is queued at its end as soon as no further step may follow.

mod driver_watch;
mod feed;
mod index;
mod lost;
mod motion;
mod outcome;
mod ramp;
mod run;
mod task;

pub(super) use outcome::{Fault, Made};
pub(super) use run::run;
pub(super) use task::{Task, most_steps_s};
