//! A node that is asked directly, rule by rule.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod changes;
mod direct;
mod faults;
mod moves;
mod ports;
mod power_up;
