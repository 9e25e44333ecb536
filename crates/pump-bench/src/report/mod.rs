//! What is said of a dose and of a bench: JSON for programs, words for people.

mod dose;
mod dose_text;
mod status;

pub use dose::{CalibrationReport, DoseReport, PhaseReport, RippleReport};
pub use status::{CalibrationStatus, Status, UnfinishedStatus};
