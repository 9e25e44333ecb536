//! A run that follows a flow over time.
//!
//! The motion is a [`pump_ctl::plan::FlowMotion`]. A plan of the same volume at the flow at which most of it passes
//! stands beside it: the calibration, the carry and the uncertainty come from that plan.

mod prepared;
mod run;

pub use prepared::PreparedProfile;
