//! The thread that holds a pump, the calls that it works on, and the stops that reach them.

mod calls;
mod progress;
mod worker;

pub(crate) use calls::Call;
pub(super) use calls::{Signal, lock};
pub(super) use progress::check_progress;
pub(super) use worker::{Held, Named, Worker, cause};
