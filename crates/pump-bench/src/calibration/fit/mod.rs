//! Fits to weighed runs: the displacement factor against speed, and the zero of the angle.

mod against_speed;
mod departures;
mod displacement;
mod expected;
mod law_fit;
mod phase;
mod points;
mod prior;
mod revolution;
mod scatter;
mod short_dose;
mod speed_bend;

pub(crate) use against_speed::AgainstSpeed;
pub use displacement::Displacement;
pub use expected::Expected;
pub(crate) use expected::scatter_ml;
pub use law_fit::LawFit;
pub(crate) use law_fit::LawToFit;
pub(crate) use phase::PulseSureness;
pub use phase::{FittedPulse, PhaseFit};
pub use prior::ScatterPrior;
pub(crate) use revolution::Revolution;
pub use scatter::Scatter;
pub use short_dose::{ShortDose, short_doses_of_csv};
pub use speed_bend::SpeedBend;
