//! The pressures that a plan makes, the time in which its line settles, and what the line takes back.

mod back_flow;
mod prediction;
mod shortened_motion;

pub use prediction::Prediction;

pub(in crate::plan) use shortened_motion::ShortenedMotion;
