//! The profile of the speed: the fastest motion to rest below a speed limit, and its legs.

mod along;
mod course;
mod down;
mod envelope;
mod legs;
mod lift;
mod lift_choice;
mod profile;
mod shape;
mod shaped;
mod smooth;
mod swing;

pub use legs::Legs;
pub use profile::Profile;

pub(in crate::plan) use along::Along;
pub(in crate::plan) use course::{Course, SpeedLimit};
pub(in crate::plan) use shape::Shape;
pub(in crate::plan) use smooth::SmoothLimit;
