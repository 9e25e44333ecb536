//! The pump head: dimensions, roller volume and flow curves, and the published numbers.

pub(crate) mod default_pulse;
pub mod flow_curve;
pub(crate) mod geometry;
pub mod paper;
pub(crate) mod pulses;
pub(crate) mod reaches;
pub mod roller_volume;
mod runs;
pub(crate) mod turn_range;
mod turns_range;
