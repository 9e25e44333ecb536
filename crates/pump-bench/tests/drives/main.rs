//! Drives that no pump file names: motors of other programs, and step and direction pins.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may panic")]

mod before_motion;
mod given;
mod met_anew;
mod servo;
mod settling;
mod stepped;
