//! The books of a pump: what the record states of angle, volume and carry holds for the true rotor.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may panic")]

mod accounts;
mod bench;
mod boards;
mod bought_heads;
mod model;
mod plant;
mod resuming;
mod weighing;
