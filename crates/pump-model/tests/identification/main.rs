//! Lines identified from simulated measurements with noise: the fit finds the truth as often as stated.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod dice;
mod joint;
mod points;
mod refusals;
mod waveforms;
