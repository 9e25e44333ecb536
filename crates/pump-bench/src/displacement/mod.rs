//! What a revolution really displaces, where that is not what the model says.

mod correction;
mod speed_law;

pub use correction::Correction;
pub use speed_law::{RangedLaw, SpeedLawError};
