//! The pressures that a plan makes, and the time in which its line settles.

mod prediction;
mod shortened_motion;

pub use prediction::Prediction;

pub(in crate::plan) use shortened_motion::ShortenedMotion;
