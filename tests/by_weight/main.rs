//! Doses by weight through the command: a simulated board with a true pump behind it, and a simulated balance under its
//! vessel, each at a pseudo-terminal of its own.

#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "a test may panic, and says which runs are void"
)]
#![cfg(unix)]

mod angles;
#[path = "../../examples/simulated_grbl/balance/mod.rs"]
mod balance;
mod cut_off;
mod doses;
mod faults;
mod ports;
mod programs;
mod rest;
mod rig;
#[allow(dead_code, reason = "the board of other tests, with more to look at")]
#[path = "../../examples/simulated_grbl/simulated/mod.rs"]
mod simulated;
