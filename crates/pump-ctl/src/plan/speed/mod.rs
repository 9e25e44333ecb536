//! The cruise speed of a plan: the speed that is asked for, or the fastest within every limit.

mod choice;
mod fastest;
mod for_flow;
mod nearest;
mod refusal;
mod rounded;
mod within;

pub use choice::MAX_DURATION_S;
pub use for_flow::speed_for_flow;

pub(in crate::plan) use choice::choose;
pub(in crate::plan) use rounded::up;
