//! The target of a dose: the whole number of steps whose volume is nearest.

mod delivered;
mod ends;
mod ends_by_volume;
mod first_end;
mod low_flow;
mod nearest;
mod target;

pub(in crate::plan) use delivered::{booked, delivered};
pub(in crate::plan) use ends::ends;
pub use first_end::MAX_STEPS;
pub(in crate::plan) use first_end::first;
pub(in crate::plan) use nearest::nearest_steps;
pub(in crate::plan) use target::Target;
