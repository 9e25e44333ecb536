//! A flow over time at the rollers, as motor steps: the inverse of the curve from the rollers' angle.

mod error;
mod flow_plan;
mod legs;
mod motion;
mod prediction;
mod row;
mod segments;
mod stop;
mod stretch;

pub use error::FlowError;
pub use flow_plan::{FlowPace, FlowPlan};
pub use legs::FlowLegs;
pub use motion::FlowMotion;
pub use row::{FlowKnot, FlowRow};
pub use segments::FlowSegments;
pub use stretch::FlowStretch;
