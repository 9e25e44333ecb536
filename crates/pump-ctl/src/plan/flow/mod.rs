//! A flow over time at the rollers, as motor steps: the inverse of the curve from the rollers' angle.

mod error;
mod flow_plan;
mod row;
mod stretch;

pub use error::FlowError;
pub use flow_plan::FlowPlan;
pub use row::FlowRow;
pub use stretch::FlowStretch;
