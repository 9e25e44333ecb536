//! Fits to weighed runs: the displacement factor against speed, and the zero of the angle.

mod against_speed;
mod displacement;
mod law_fit;
mod phase;
mod revolution;
mod straight;

pub use against_speed::AgainstSpeed;
pub use displacement::{Displacement, Expected};
pub use law_fit::LawFit;
pub use phase::{PhaseFit, ShortDose, short_doses_of_csv};
pub use revolution::Revolution;
