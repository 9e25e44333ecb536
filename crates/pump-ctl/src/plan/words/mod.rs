//! The words of a plan: its choices, its request and its refusals. They name no other room.

mod cruise;
mod error;
mod finish;
mod limited_by;
mod phase;
mod ramps;
mod request;
mod retarget;
mod set_by;
mod start_angles;
mod turned;
mod unknown_name;

pub use cruise::Cruise;
pub use error::{Nearest, PlanError};
pub use finish::Finish;
pub use limited_by::LimitedBy;
pub use phase::Phase;
pub use ramps::Ramps;
pub use request::{MAX_VOLUME_ML, Request};
pub use retarget::Retarget;
pub use set_by::SetBy;
pub use turned::Turned;
pub use unknown_name::UnknownName;

/// Range of a parameter, which the model and the plan word alike.
pub use pump_model::Allowed;

pub(in crate::plan) use error::within;
