//! Lines identified from simulated measurements with noise: what is found is the truth, as often as stated.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod dice;
mod points;
mod refusals;
mod waveforms;
