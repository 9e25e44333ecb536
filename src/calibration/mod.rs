//! Calibrations: what a pump really displaces, from runs that were weighed, and how sure that is.

mod active;
#[cfg(test)]
mod coverage;
mod date;
mod displacement;
mod error;
mod making;
mod phase;
mod plan;
mod run;
mod store;
mod student;
mod table;
mod verification;
pub mod weighing;

pub use active::{Applied, Calibration, Correction, Source, Sureness};
pub use date::now as now_utc;
pub use displacement::{Displacement, Expected};
pub use error::CalibrationError;
pub use phase::{PhaseFit, Revolution, ShortDose, short_doses_of_csv};
pub(crate) use plan::Planner;
pub use run::{Reading, Run, runs_of_csv};
pub use store::{Calibrations, Stored};
pub use verification::{Tolerance, Verification, readings_of_csv};
pub use weighing::Weighing;
