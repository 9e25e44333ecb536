//! Ways to rest: down the brake, or in the steps that are left to the end of the plan.

mod brake;
mod error;
mod final_ramp;
mod way_down;

pub use brake::{BRAKE_ENTRIES, Brake};
pub use error::BrakeError;
pub(super) use way_down::WayDown;
