//! An axis: a motor, its executor, its moves and its faults.

mod axis;
mod faults;
mod moves;
mod pulse;
mod timing;

pub(crate) use axis::{Axis, NEVER};
pub(crate) use timing::{ns_in_ticks, rate_hz};
