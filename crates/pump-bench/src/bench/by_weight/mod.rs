//! A dose that a balance ends.
//!
//! The journal has it as one dose that stays unfinished until the balance shows what was asked for. The pump turns in
//! stretches, fast ones and then slow ones. Each is planned to end below the target however far the pump may be off,
//! and the balance stops it sooner where it delivers more. The vessel is weighed at rest after each.

mod aim;
mod angles;
mod at_rest;
mod begun;
mod course;
mod delivered;
mod lookout;
mod prepared;
mod readings;
mod rest;
mod run;
mod tolerance;

pub use delivered::DeliveredByWeight;
pub use prepared::{OrderByWeight, PreparedByWeight};
pub use tolerance::ToleranceBy;
