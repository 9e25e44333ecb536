//! Corrections of the displaced volume: by a calibration and by a speed law.

mod correction;
mod speed_law;

pub use correction::Correction;
pub use speed_law::{RangedLaw, SpeedLawError};
