//! The displaced volume: its correction by a calibration, and its dependence on the speed.

mod correction;
mod error;
mod law;
mod pulse;
mod pulse_bounds;
mod pulse_prior;
mod pulse_spread;
mod speed_dependent_pump;
#[cfg(test)]
mod tests;

pub use correction::Correction;
pub use error::DisplacementError;
pub use law::DisplacementLaw;
pub use pulse::PulseCorrection;
pub use pulse_bounds::PulseBounds;
pub use pulse_prior::PulsePrior;
pub use speed_dependent_pump::SpeedDependentPump;
