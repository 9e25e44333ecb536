//! Claims about the drive of a node, over a line in virtual time to the board's own logic.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod boards;
mod doses;
mod faults;
#[path = "../plans/flow.rs"]
mod flow;
mod flows;
mod meeting;
mod onlooker;
mod racks;
mod rates;
mod rig;
mod sessions;
mod several;
mod sharing;
mod streaming;
mod together;
mod world;
