//! Series of motions that are planned ahead: batches that are rehearsed, and the parts of a rack.

mod rehearsal;
mod series;

pub use rehearsal::Rehearsal;
pub use series::{SeriesMotion, SeriesRequest};
