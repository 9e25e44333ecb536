//! Sizing: a head, its speed, and the pressures, the margins and the pulsation that hoses and lifts leave it.

mod candidates;
mod curve;
mod duty;
mod error;
mod largest_pressure;
mod line;
mod operating;
mod pulsation;
mod refusal;
mod settling;
mod sizing;
mod suction;
#[cfg(test)]
mod tests;
mod working_pressure;

pub use candidates::heads_for;
pub use curve::CurvePoint;
#[cfg(feature = "plot")]
pub use curve::curve_svg;
pub use duty::Duty;
pub use error::{Shortfall, SizingError, WouldDo};
pub use largest_pressure::{LargestPressure, PressureSource};
pub use line::{FlowLaw, SizedLine};
pub use pulsation::Pulsation;
pub(crate) use sizing::LONGEST_PITCH_S;
pub use sizing::{SizedHead, Sizing};
pub use suction::Suction;
