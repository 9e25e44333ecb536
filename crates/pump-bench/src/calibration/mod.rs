//! Calibrations: the displacement of a pump by weighed runs, with its uncertainty.

mod applied;
mod calibration;
mod date;
mod error;
mod fit;
mod making;
mod run;
mod run_log;
mod store;
mod verification;
mod weighing;

pub use applied::{Applied, Basis, Made, Sureness};
pub use calibration::{Calibration, Source};
pub use date::now as now_utc;
pub use error::CalibrationError;
pub use fit::{
    AgainstSpeed, Displacement, Expected, LawFit, PhaseFit, Revolution, Scatter, ShortDose,
    short_doses_of_csv,
};
pub use making::Fit;
pub use run::{Reading, Run, runs_of_csv};
pub use run_log::{PlannedRuns, RunLog, UnfinishedRuns};
pub use store::{Calibrations, Stored};
pub use verification::{Tolerance, Verification, readings_of_csv};
pub use weighing::Weighing;
