//! The command as a user types it: exit codes, messages, files, and that nothing moves when it refuses.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod batches;
mod calibrate;
mod doses;
mod drawings;
mod endings;
mod files;
mod finish;
mod fluids;
mod identify;
mod limits;
mod refusals;
mod retraction;
mod simulations;
mod speed_law;
#[cfg(unix)]
mod terminal;
mod tube;
mod unknown_angle;
mod user;
