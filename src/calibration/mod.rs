//! Calibrations: what a pump really displaces, from runs that were weighed, and how sure that is.

mod active;
mod against_speed;
#[cfg(test)]
mod coverage;
mod date;
mod displacement;
mod error;
mod law_fit;
mod making;
mod phase;
mod plan;
mod revolution;
mod run;
mod store;
mod straight;
mod verification;
pub mod weighing;

pub use active::{Applied, Calibration, Correction, Made, Source, Sureness};
pub use against_speed::AgainstSpeed;
pub use date::now as now_utc;
pub use displacement::{Displacement, Expected};
pub use error::CalibrationError;
pub use law_fit::LawFit;
pub use making::Fit;
pub use phase::{PhaseFit, ShortDose, short_doses_of_csv};
pub(crate) use plan::Planner;
pub use revolution::Revolution;
pub use run::{Reading, Run, runs_of_csv};
pub use store::{Calibrations, Stored};
pub use verification::{Tolerance, Verification, readings_of_csv};
pub use weighing::Weighing;
