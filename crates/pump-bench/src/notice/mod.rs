//! Notices for a person: warnings and notes, with the remedies that a front end words.

mod notice;
mod remedy;
mod sources;

pub use notice::Notice;
pub(crate) use notice::with_remedies;
pub use remedy::{Remedy, Wording};
pub use sources::with_sources;
pub(crate) use sources::{DEVICE_FAILED, PROGRAM_REFUSED};
