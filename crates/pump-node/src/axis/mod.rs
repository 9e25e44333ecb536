//! An axis: a motor, its executor, its moves and its faults.

mod axis;
mod faults;
mod moves;
mod pulse;
mod setup;
mod timing;

pub use axis::Axis;
pub(crate) use axis::NEVER;
pub(crate) use moves::Checked;
pub(crate) use setup::Setup;
pub(crate) use timing::tick_rate;
