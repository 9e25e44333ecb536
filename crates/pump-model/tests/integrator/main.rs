//! The integrators: order, tolerance, stiff problems of the literature, stops and errors.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod errors;
mod order;
mod problems;
mod radau;
mod stiff;
mod stops;
mod tolerance;
